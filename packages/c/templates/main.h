    laconic_single_status status = start_robot();
    for (int second = 1; second <= 2 && status == LACONIC_SINGLE_OK; second++) {
        const laconic_single_pose pose = pose_after(100, &status);
        printf("after %d s at x = %.3f m, y = %.3f m, heading %.3f rad\n", second, (double)pose.x_m, (double)pose.y_m,
               (double)pose.heading_rad);
    }

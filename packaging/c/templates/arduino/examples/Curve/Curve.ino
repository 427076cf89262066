// A robot drives a curve to the left, one step each 10 ms, and its pose is printed each second.
#include <laconic_single.h>

@robot@
void setup() {
    Serial.begin(115200);
    if (start_robot() != LACONIC_SINGLE_OK) Serial.println("the vehicle is refused");
}

void loop() {
    laconic_single_status status;
    const laconic_single_pose pose = pose_after(100, &status);
    Serial.print("x [m] ");
    Serial.print(pose.x_m, 3);
    Serial.print("  y [m] ");
    Serial.print(pose.y_m, 3);
    Serial.print("  heading [rad] ");
    Serial.println(pose.heading_rad, 3);
    delay(1000);
}

/* A robot of an SDF file in Gazebo's physics, driven by motors at its wheels: gazebo PLUGIN FILE STEP GAIN DAMPING JOINT …
 *
 * Standard input has lines "until voltage …" with a voltage for each joint. Prints x, y, heading and the microseconds
 * that a step took. */
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <ignition/physics/ForwardStep.hh>
#include <ignition/physics/FrameSemantics.hh>
#include <ignition/physics/GetEntities.hh>
#include <ignition/physics/Joint.hh>
#include <ignition/physics/RequestEngine.hh>
#include <ignition/physics/sdf/ConstructWorld.hh>
#include <ignition/plugin/Loader.hh>
#include <sdf/Root.hh>
#include <sdf/World.hh>

namespace physics = ignition::physics;

struct Features : physics::FeatureList<physics::sdf::ConstructSdfWorld, physics::ForwardStep, physics::LinkFrameSemantics,
                                       physics::GetModelFromWorld, physics::GetLinkFromModel,
                                       physics::GetJointFromModel, physics::GetBasicJointState,
                                       physics::SetBasicJointState> {};

int main(int count, char **words) {
    if (count < 7) return std::fputs("gazebo PLUGIN FILE STEP GAIN DAMPING JOINT ...\n", stderr), 2;
    const double step_s = std::atof(words[3]), gain = std::atof(words[4]), damping = std::atof(words[5]);
    ignition::plugin::Loader loader;
    loader.LoadLib(words[1]);
    const auto names = loader.PluginsImplementing<physics::ForwardStep::Implementation<physics::FeaturePolicy3d>>();
    if (names.empty()) return std::fputs("no engine in the plugin\n", stderr), 1;
    const auto engine = physics::RequestEngine3d<Features>::From(loader.Instantiate(*names.begin()));
    sdf::Root root;
    for (const auto &error : root.Load(words[2])) std::fprintf(stderr, "%s\n", error.Message().c_str());
    if (!engine || !root.WorldByIndex(0)) return std::fputs("no world\n", stderr), 1;
    auto world = engine->ConstructWorld(*root.WorldByIndex(0));
    auto robot = world->GetModel("robot");
    std::vector<decltype(robot->GetJoint(""))> joints;
    for (int i = 6; i < count; ++i) joints.push_back(robot->GetJoint(words[i]));
    physics::ForwardStep::Input input;
    physics::ForwardStep::Output output;
    physics::ForwardStep::State state;
    input.Get<std::chrono::steady_clock::duration>() = std::chrono::nanoseconds(std::llround(step_s * 1e9));
    std::vector<double> voltage_V(joints.size());
    double until_s;
    long steps = 0;
    const auto began = std::chrono::steady_clock::now();
    while (std::scanf("%lf", &until_s) == 1) {
        for (auto &each : voltage_V)
            if (std::scanf("%lf", &each) != 1) return 2;
        for (; steps < std::lround(until_s / step_s); ++steps) {
            for (std::size_t i = 0; i < joints.size(); ++i)
                joints[i]->SetForce(0, gain * voltage_V[i] - damping * joints[i]->GetVelocity(0));
            world->Step(output, state, input);
        }
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    const auto pose = robot->GetLink("base")->FrameDataRelativeToWorld().pose;
    std::printf("%.9f %.9f %.9f %.3f\n", pose.translation().x(), pose.translation().y(),
                std::atan2(pose.linear()(1, 0), pose.linear()(0, 0)), 1e6 * seconds / steps);
    return 0;
}

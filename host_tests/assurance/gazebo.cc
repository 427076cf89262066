/* A robot of an SDF file in Gazebo's physics: gazebo PLUGIN FILE STEP MOTORS JOINT … DAMPING …
 *
 * The first MOTORS joints have motors, each with a damping; the others are steered. Standard input has one line for each step: the torques
 * of the motors, then the angles of the steered joints at its end. Prints x, y and heading of the link "base", then the
 * microseconds that a step took. */
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

struct Features
    : physics::FeatureList<physics::sdf::ConstructSdfWorld, physics::ForwardStep, physics::LinkFrameSemantics,
                           physics::GetModelFromWorld, physics::GetLinkFromModel, physics::GetJointFromModel,
                           physics::GetBasicJointState, physics::SetBasicJointState,
                           physics::SetJointVelocityCommandFeature> {};

int main(int count, char **words) {
    if (count < 6) return std::fputs("gazebo PLUGIN FILE STEP MOTORS JOINT ... DAMPING ...\n", stderr), 2;
    const double step_s = std::atof(words[3]);
    const std::size_t motors = std::strtoul(words[4], nullptr, 10);
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
    const int first_damping = count - static_cast<int>(motors);
    for (int i = 5; i < first_damping; ++i) joints.push_back(robot->GetJoint(words[i]));
    std::vector<double> damping;
    for (int i = first_damping; i < count; ++i) damping.push_back(std::atof(words[i]));
    std::vector<double> values;
    for (double each; std::scanf("%lf", &each) == 1;) values.push_back(each);
    physics::ForwardStep::Input input;
    physics::ForwardStep::Output output;
    physics::ForwardStep::State state;
    input.Get<std::chrono::steady_clock::duration>() = std::chrono::nanoseconds(std::llround(step_s * 1e9));
    const std::size_t steps = values.size() / joints.size();
    const auto began = std::chrono::steady_clock::now();
    for (std::size_t step = 0; step < steps; ++step) {
        const double *given = &values[step * joints.size()];
        for (std::size_t i = 0; i < joints.size(); ++i) {
            if (i < motors)
                joints[i]->SetForce(0, given[i] - damping[i] * joints[i]->GetVelocity(0));
            else
                joints[i]->SetVelocityCommand(0, (given[i] - joints[i]->GetPosition(0)) / step_s);
        }
        world->Step(output, state, input);
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    const auto pose = robot->GetLink("base")->FrameDataRelativeToWorld().pose;
    std::printf("%.9f %.9f %.9f %.3f\n", pose.translation().x(), pose.translation().y(),
                std::atan2(pose.linear()(1, 0), pose.linear()(0, 0)), 1e6 * seconds / static_cast<double>(steps));
    return 0;
}

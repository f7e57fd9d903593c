// Steps an SDFormat world in Gazebo's plugin for DART, and prints places of links and positions of joints as JSON lines.
// Usage: gazebo_dart PLUGIN WORLD STEPS
#include <cstdlib>
#include <iomanip>
#include <iostream>

#include <ignition/physics/FindFeatures.hh>
#include <ignition/physics/ForwardStep.hh>
#include <ignition/physics/FrameSemantics.hh>
#include <ignition/physics/GetEntities.hh>
#include <ignition/physics/Joint.hh>
#include <ignition/physics/RequestEngine.hh>
#include <ignition/physics/sdf/ConstructJoint.hh>
#include <ignition/physics/sdf/ConstructLink.hh>
#include <ignition/physics/sdf/ConstructModel.hh>
#include <ignition/physics/sdf/ConstructWorld.hh>
#include <ignition/plugin/Loader.hh>
#include <sdf/Root.hh>
#include <sdf/World.hh>

namespace physics = ignition::physics;

struct Features : physics::FeatureList<physics::LinkFrameSemantics, physics::ForwardStep, physics::GetEntities,
                                       physics::GetBasicJointState, physics::GetBasicJointProperties,
                                       physics::sdf::ConstructSdfWorld,
                                       physics::sdf::ConstructSdfModel, physics::sdf::ConstructSdfLink,
                                       physics::sdf::ConstructSdfJoint> {};

int main(int count, char **arguments) {
  if (count != 4) return 2;
  ignition::plugin::Loader loader;
  loader.LoadLib(arguments[1]);
  const auto names = physics::FindFeatures3d<Features>::From(loader);
  sdf::Root root;
  if (names.empty() || !root.Load(arguments[2]).empty() || root.WorldByIndex(0) == nullptr) return 3;
  auto engine = physics::RequestEngine3d<Features>::From(loader.Instantiate(*names.begin()));
  auto world = engine->ConstructWorld(*root.WorldByIndex(0));
  physics::ForwardStep::Output output;
  physics::ForwardStep::State state;
  physics::ForwardStep::Input input;
  const int steps = std::atoi(arguments[3]);
  std::cout << std::setprecision(17);
  for (int step = 0; step <= steps; ++step) {
    if (step == 0 || step == steps) {
      for (std::size_t m = 0; m < world->GetModelCount(); ++m) {
        auto model = world->GetModel(m);
        for (std::size_t i = 0; i < model->GetLinkCount(); ++i) {
          auto link = model->GetLink(i);
          const auto place = link->FrameDataRelativeToWorld().pose.translation().eval();
          std::cout << "[" << step << ", \"link\", \"" << link->GetName() << "\", [" << place[0] << ", " << place[1]
                    << ", " << place[2] << "]]\n";
        }
        for (std::size_t i = 0; i < model->GetJointCount(); ++i) {
          auto joint = model->GetJoint(i);
          if (joint->GetDegreesOfFreedom() == 1)
            std::cout << "[" << step << ", \"joint\", \"" << joint->GetName() << "\", " << joint->GetPosition(0)
                      << "]\n";
        }
      }
    }
    world->Step(output, state, input);
  }
}

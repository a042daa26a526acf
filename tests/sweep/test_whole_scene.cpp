// Samples know the whole scene that they are of.
#include "sweep_test.hpp"

#include "tests/catalogue.hpp"

namespace rbvi::whole_scene_test {
namespace {

using namespace testing_sweep;

TEST_F(SweepTest, SamplesOfAnotherSceneAreRefused) {
  (void)sweep({five[0]});
  Scene other = wide_scene();
  const std::string load = "loads.pressure.force: ";
  other.tree.insert(other.tree.find(load) + load.size(), "2*");
  const Error error = refusal(other);
  EXPECT_EQ(error.status(), Status::bad_input);
  EXPECT_TRUE(contains(error.what(), "are of another scene: force of pressure is 2*"))
      << error.what();
  EXPECT_TRUE(contains(error.what(), "rbvi offline makes them anew in another -out"))
      << error.what();
  EXPECT_EQ(sweep({five[0]}).report.reused, 1);
}

TEST_F(SweepTest, SamplesOfAnotherOrderOfParametersAreRefused) {
  (void)sweep({five[0]});
  Scene turned = wide_scene();
  turned.parameters = free_only(turned.parameters, "center_y,center_x,radius");
  const Error error = refusal(turned);
  EXPECT_EQ(error.status(), Status::bad_input);
  EXPECT_TRUE(contains(error.what(), "parameters = radius,center_x,center_y, now it is center_y"))
      << error.what();
}

TEST_F(SweepTest, TheOrderOfParametersDoesNotChangeAnswers) {
  Scene turned = wide_scene();
  turned.parameters = free_only(turned.parameters, "center_y,radius,center_x");
  const Sweep one = sweep({{0.18, 0.02, -0.01}}),
              other = sweep({{-0.01, 0.18, 0.02}}, 1, turned, {}, "turned");
  EXPECT_EQ(one.samples.front().u, other.samples.front().u);
}

} // namespace
} // namespace rbvi::whole_scene_test

// The EDS of a controller node against the node on the virtual bus.
#include <gtest/gtest.h>

#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/eds/to_eds.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "walked_device.hpp"

namespace breakaway::eds {
namespace {

config::Node node_of(const std::string& file) { return scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/" + file).node; }

// Under the mark of a certificate, whose numbers matter to no object.
config::AnyNode<float> started(const config::Node& node) {
  auto flashed = config::flashed<float>(node);
  for (auto& axis : present_axes(flashed)) axis.certified = true;
  flashed.checksum = firmware::checksum_of(flashed);
  return flashed;
}

class WalkedNode final : public WalkedDevice {
 public:
  explicit WalkedNode(const config::Node& node)
      : WalkedDevice{node.loop->node_id}, flashed_{started(node)}, node_{device, flashed_} {
    EXPECT_TRUE(node_.verdict().ok());
    run_for(100ms);
  }

 private:
  void advance() override {
    bus.advance_to(now);
    node_.step(now);
  }

  config::AnyNode<float> flashed_;
  firmware::ControlNode<virtual_bus::VirtualBus::Port, config::AnyNode<float>> node_;
};

EdsFile eds_of(const config::Node& node) {
  return EdsFile{to_eds(node_device(node), "node.eds", std::chrono::system_clock::from_time_t(0))};
}

class NodeEds : public ::testing::TestWithParam<const char*> {
 protected:
  config::Node node = node_of(GetParam());
};

TEST_P(NodeEds, SaysWhatAnswersOnTheBus) {
  WalkedNode walked{node};
  expect_device_as_written(walked, eds_of(node));
}

TEST_P(NodeEds, LeavesNoObjectOut) {
  WalkedNode walked{node};
  expect_nothing_else(walked, eds_of(node));
}

TEST_P(NodeEds, ListsEveryObjectOnce) { expect_lists_complete(eds_of(node)); }

INSTANTIATE_TEST_SUITE_P(Files, NodeEds,
                         ::testing::Values("sim/scenarios/can_axis.toml", "firmware/examples/two_axes.toml"));

TEST(NodeEdsText, SaysNamesPeriodAndTheLimitsOfATarget) {
  const EdsFile file = eds_of(node_of("firmware/examples/two_axes.toml"));
  EXPECT_NEAR(std::stod(file.sections.at("2101sub2").at("HighLimit")), 5e5, 1);
  EXPECT_NEAR(std::stod(file.sections.at("2101sub2").at("LowLimit")), -5e5, 1);
  EXPECT_NEAR(std::stod(file.sections.at("2102sub2").at("HighLimit")), 3e5, 1);
  EXPECT_EQ(file.sections.at("2101sub1").at("DefaultValue"), "x");
  EXPECT_EQ(file.sections.at("2101sub5").at("DataType"), "0x0008");
  EXPECT_EQ(file.sections.at("1008").at("DefaultValue"), "breakaway");
  EXPECT_EQ(file.sections.at("2000sub2").at("DefaultValue"), "0x000F4240");
}

TEST(NodeEdsText, ListsTheBitRatesThatThePeriodLeavesRoomFor) {
  const EdsFile file = eds_of(node_of("firmware/examples/two_axes.toml"));
  const Section& device = file.sections.at("DeviceInfo");
  EXPECT_EQ(device.at("BaudRate_1000"), "1");
  EXPECT_EQ(device.at("BaudRate_500"), "0");
  EXPECT_EQ(device.at("BaudRate_10"), "0");
}

TEST(NodeEdsText, IsRefusedWithoutALoop) {
  EXPECT_THROW(node_device(node_of("sim/scenarios/impulsive_example.toml")), InputError);
}

}  // namespace
}  // namespace breakaway::eds

#include "breakaway/report/formats.hpp"

#include <gtest/gtest.h>

namespace {

using breakaway::report::to_candump;
using breakaway::report::to_csv;
using breakaway::sil::Result;

TEST(Candump, WritesTheLogFormatOfCanUtils) {
  Result result;
  result.frames = {{0.001048, {.id = 0x080}},
                   {12.5, {.id = 0x201, .size = 4, .data = {0x0F, 0x00, 0xD0, 0x07}}},
                   {13.0, {.id = 0x7FF, .size = 2, .remote = true}}};
  EXPECT_EQ(to_candump(result),
            "(0000000000.001048) can0 080#\n"
            "(0000000012.500000) can0 201#0F00D007\n"
            "(0000000013.000000) can0 7FF#R2\n");
}

breakaway::scenario::Scenario scenario_of(std::size_t axes) {
  breakaway::scenario::Scenario s;
  s.node.axes.resize(axes);
  return s;
}

TEST(Csv, HasAHeaderAndOneLineASample) {
  Result result;
  result.axes.emplace_back().trace = {{.time_s = 0.5, .position_m = -0.25, .force_N = 3}};
  EXPECT_EQ(to_csv(scenario_of(result.axes.size()), result),
            "time_s,position_m,velocity_m_s,target_m,force_N,friction_level_N,bus_load,mode\n"
            "0.5,-0.25,0,0,3,0,0,approach\n");
}

TEST(Csv, NamesTheAxisOfEachSampleWhereThereAreSeveral) {
  Result result;
  for (const char* name : {"x", "y"}) {
    result.axes.emplace_back().name = name;
    result.axes.back().trace = {{.time_s = 0.5}};
  }
  EXPECT_EQ(to_csv(scenario_of(result.axes.size()), result),
            "axis,time_s,position_m,velocity_m_s,target_m,force_N,friction_level_N,bus_load,mode\n"
            "x,0.5,0,0,0,0,0,0,approach\n"
            "y,0.5,0,0,0,0,0,0,approach\n");
}

Result on_a_machine() {
  Result result;
  for (const char* name : {"x", "y"}) {
    result.axes.emplace_back().name = name;
    result.axes.back().trace = {{.time_s = 0.5}};
  }
  result.machine_end = {0.5, Eigen::Vector3d{1, 2, 3}, Eigen::Vector3d{0, 0, 0.5}};
  result.machine_trace = {*result.machine_end};
  return result;
}

TEST(Csv, ShowsTheCoordinatesOfTheMachineBehindTheAxes) {
  EXPECT_EQ(to_csv(scenario_of(2), on_a_machine()),
            "axis,time_s,position_m,velocity_m_s,target_m,force_N,friction_level_N,bus_load,mode,q1,q2,q3\n"
            "x,0.5,0,0,0,0,0,0,approach,1,2,3\n"
            "y,0.5,0,0,0,0,0,0,approach,1,2,3\n");
}

TEST(Json, ShowsWhereTheMachineBehindTheAxesEnded) {
  const std::string json = breakaway::report::to_json(scenario_of(2), on_a_machine());
  EXPECT_NE(json.find("\"machine\": {\n    \"q_end\": [1, 2, 3],\n    \"v_end\": [0, 0, 0.5]\n  }"), std::string::npos)
      << json;
}

}  // namespace

// The command as a user's script sees it: exit codes, one line on standard error, the contracts of its JSON.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "../scratch_folder.hpp"

namespace breakaway::testing {

namespace fs = std::filesystem;

inline const std::string scenarios = BREAKAWAY_SOURCE_DIR "/sim/scenarios/";

struct Ended {
  int exit_code;
  std::string out, err;
};

class Command : public ScratchFolder {
 protected:
  Ended run(const std::string& arguments, const std::string& environment = "") const {
    const std::string command =
        environment + " '" BREAKAWAY_COMMAND "' " + arguments + " > " + path("out") + " 2> " + path("err");
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content(path("out")), content(path("err"))};
  }

  void expect_refused(const std::string& arguments, const std::vector<std::string>& named,
                      const std::string& environment = "") const {
    const Ended ended = run(arguments, environment);
    EXPECT_EQ(ended.exit_code, 2) << arguments;
    EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
    for (const auto& part : named) EXPECT_NE(ended.err.find(part), std::string::npos) << part << " in " << ended.err;
  }

  std::string scenario(const std::string& text) const {
    std::ofstream{path("axis.toml")} << text;
    return path("axis.toml");
  }
};

// The number after the first "name": in JSON text; NaN if it is not there.
inline double figure(const std::string& json, const std::string& name) {
  const auto at = json.find('"' + name + "\": ");
  return at == std::string::npos ? std::nan("") : std::strtod(json.c_str() + at + name.size() + 4, nullptr);
}

inline void expect_keys(const std::string& json, const std::vector<std::string>& names) {
  for (const auto& name : names) EXPECT_NE(json.find('"' + name + "\":"), std::string::npos) << name;
}

}  // namespace breakaway::testing

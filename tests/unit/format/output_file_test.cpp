// Outputs are there completely or not at all.
#include "breakaway/format/output_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "../scratch_folder.hpp"
#include "breakaway/input/input_error.hpp"

namespace {

using breakaway::InputError;
using breakaway::format::write_output;
namespace fs = std::filesystem;

class OutputFile : public breakaway::testing::ScratchFolder {
 protected:
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator{folder_}, fs::directory_iterator{}); }
};

TEST_F(OutputFile, ReplacesAnOlderFileAndLeavesNothingElse) {
  write_output(path("a.json"), "a longer text");
  write_output(path("a.json"), "new");
  EXPECT_EQ(content(path("a.json")), "new");
  EXPECT_EQ(files(), 1);
}

TEST_F(OutputFile, WritesThroughALink) {
  write_output(path("real"), "old");
  fs::create_symlink(path("real"), path("link"));
  write_output(path("link"), "new");
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(content(path("real")), "new");
}

TEST_F(OutputFile, NamesTheFolderThatIsMissing) {
  try {
    write_output(path("none/a.json"), "text");
    FAIL() << "written";
  } catch (const InputError& error) {
    EXPECT_NE(std::string{error.what()}.find("none/a.json"), std::string::npos);
  }
  EXPECT_EQ(files(), 0);
}

TEST_F(OutputFile, ReportsAFullDisk) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  EXPECT_THROW(write_output("/dev/full", std::string(100'000, 'x')), InputError);
  EXPECT_THROW(write_output("/dev/full", "short"), InputError);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(OutputFile, LeavesNothingWhenThePlaceIsAFolder) {
  fs::create_directory(path("folder"));
  EXPECT_THROW(write_output(path("folder"), "text"), InputError);
  EXPECT_EQ(files(), 1);
}

}  // namespace

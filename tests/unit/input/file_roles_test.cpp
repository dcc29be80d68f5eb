#include "breakaway/input/file_roles.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "../refusal.hpp"
#include "../scratch_folder.hpp"

namespace breakaway {
namespace {

namespace fs = std::filesystem;
using testing::refusal;

class FileRoles : public testing::ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    std::ofstream{path("axis.toml")} << "there";
  }

  std::string why_not(const std::vector<NamedFile>& written) const {
    return refusal([&] { require_apart({{"axis", path("axis.toml")}, {"--log", ""}}, written); });
  }
  // The same place by a longer way.
  std::string detour(const std::string& name) const { return path("new/.././" + name); }
};

TEST_F(FileRoles, TakeFilesOfTheirOwnAndThoseThatAreNotGiven) {
  EXPECT_EQ(why_not({}), "");
  EXPECT_EQ(why_not({{"--json", path("a")}, {"--csv", path("b")}, {"--report", ""}, {"--header", ""}}), "");
  EXPECT_EQ(why_not({{"--json", "-"}, {"--csv", path("-")}}), "");
}

TEST_F(FileRoles, AreRefusedWhereAnOutputIsAnInputUnderWhicheverName) {
  fs::create_symlink(path("axis.toml"), path("symbolic"));
  fs::create_hard_link(path("axis.toml"), path("hard"));
  for (const std::string& name : {path("axis.toml"), path("symbolic"), path("hard"), detour("axis.toml")}) {
    const std::string why = why_not({{"--csv", path("a")}, {"--json", name}});
    EXPECT_NE(why.find(name + ": --json would write over a file that is read"), std::string::npos) << why;
  }
}

TEST_F(FileRoles, AreRefusedWhereTwoOutputsAreOneFileThereOrNot) {
  fs::create_directory(path("new"));
  for (const auto& [one, other] : std::vector<std::pair<std::string, std::string>>{
           {path("a"), path("a")}, {path("a"), detour("a")}, {detour("new/a"), path("new/a")}, {"-", "-"}}) {
    const std::string why = why_not({{"--json", one}, {"--header", other}});
    EXPECT_NE(why.find(other + ": two outputs would go there, --json and --header"), std::string::npos) << why;
  }
}

TEST_F(FileRoles, AreRefusedWhereAnOutputBehindOneThatIsNotGivenIsAnother) {
  EXPECT_EQ(why_not({{"--report", ""}, {"--json", path("a")}}), "");
  EXPECT_NE(why_not({{"--report", ""}, {"--json", path("a")}, {"--csv", path("a")}}), "");
}

TEST_F(FileRoles, LetOneInputComeFromStandardInputAndNoMore) {
  EXPECT_EQ(refusal([&] { require_apart({{"axis", path("axis.toml")}, {"--record", "-"}}, {{"--json", "-"}}); }), "");
  const std::string why = refusal([] { require_apart({{"axis", "-"}, {"--record", "-"}}, {}); });
  EXPECT_NE(why.find("two inputs would come from there, axis and --record"), std::string::npos) << why;
}

// What becomes of such a name its opening says.
TEST_F(FileRoles, TakeANameThatTheSystemCannotFollowForNoOtherFile) {
  fs::create_symlink(path("round"), path("round"));
  EXPECT_FALSE(same_file(path("round") + "/a", path("axis.toml")));
  EXPECT_FALSE(same_file(path("axis.toml"), path("round") + "/a"));
}

TEST_F(FileRoles, LetADeviceBeReadAndWritten) {
  EXPECT_EQ(refusal([] { require_apart({{"axis", "/dev/null"}}, {{"--json", "/dev/null"}}); }), "");
}

}  // namespace
}  // namespace breakaway

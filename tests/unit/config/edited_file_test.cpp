#include "breakaway/config/edited_file.hpp"

#include <gtest/gtest.h>

#include <string>

#include "../refusal.hpp"
#include "breakaway/config/new_node.hpp"
#include "breakaway/config/read_node.hpp"

namespace breakaway::config {
namespace {

std::string set(const std::string& text, const Setting& setting, const std::string& axis = "") {
  return with_settings(text, "axis.toml", axis, {setting});
}

TEST(EditedFile, ChangesTheValueAndKeepsEverythingElse) {
  EXPECT_EQ(set("# of K\u00f6ln\n[plant] # one\r\n mass_kg=1.5e0  # two\nother = 2", {"plant", "mass_kg", "12"}),
            "# of K\u00f6ln\n[plant] # one\r\n mass_kg=12  # two\nother = 2");
  EXPECT_EQ(set("plant = { name = \"\u00e4\u00f6\", mass_kg = 1 } # \u00fc\n", {"plant", "mass_kg", "2"}),
            "plant = { name = \"\u00e4\u00f6\", mass_kg = 2 } # \u00fc\n");
}

TEST(EditedFile, AddsAKeyBehindThoseOfItsTable) {
  EXPECT_EQ(set("[a]\nx = 1 # x\n\n[a.b]\ny = 2\n", {"a", "z", "3"}), "[a]\nx = 1 # x\nz = 3\n\n[a.b]\ny = 2\n");
  EXPECT_EQ(set("[a]", {"a", "z", "3"}), "[a]\nz = 3\n");
  EXPECT_EQ(set("a = { x = 1 }\n", {"a", "z", "3"}), "a = { x = 1, z = 3 }\n");
  EXPECT_EQ(set("a = {}\n", {"a", "z", "3"}), "a = { z = 3}\n");
}

TEST(EditedFile, AddsATableThatIsMissing) {
  EXPECT_EQ(set("x = 1", {"move", "z", "3"}), "x = 1\n\n[move]\nz = 3\n");
  EXPECT_EQ(set("[[axis]]\nname = \"a\"\n[[axis]]\nname = \"b\" # b\nplant = { x = 1 }\n", {"move", "z", "3"}, "a"),
            "[[axis]]\nname = \"a\"\nmove = { z = 3 }\n[[axis]]\nname = \"b\" # b\nplant = { x = 1 }\n");
}

TEST(EditedFile, SetsKeysOfOneAxisAndOfTheNode) {
  const std::string text =
      "[run]\nd = 1\n[[axis]]\nname = \"a\"\n[axis.plant]\nx = 1\n[[axis]]\nname = \"b\"\n"
      "[axis.plant]\nx = 1\n";
  EXPECT_EQ(set(text, {"plant", "x", "2"}, "b"),
            "[run]\nd = 1\n[[axis]]\nname = \"a\"\n[axis.plant]\nx = 1\n[[axis]]\nname = \"b\"\n[axis.plant]\nx = 2\n");
  EXPECT_EQ(set(text, {"run", "d", "2"}, "b").substr(0, 11), "[run]\nd = 2");
  const std::string why = breakaway::testing::refusal([&] { set(text, {"plant", "x", "2"}, "c"); });
  EXPECT_NE(why.find("axis.toml"), std::string::npos) << why;
  EXPECT_NE(why.find("no axis \"c\""), std::string::npos) << why;
}

TEST(EditedFile, LeadsToTheSameDataSheetsFromAnotherFolder) {
  const std::string one = "[drive]\neds = 'a \"b\".eds' # its own\n[run]\n";
  EXPECT_EQ(moved_text(one, "/p/x/axis.toml", "/p/y/z/axis.toml"),
            "[drive]\neds = '../../x/a \"b\".eds' # its own\n[run]\n");
  EXPECT_EQ(moved_text(one, "/p/x/axis.toml", "/p/axis.toml"), "[drive]\neds = 'x/a \"b\".eds' # its own\n[run]\n");
  EXPECT_EQ(moved_text(one, "/p/x/axis.toml", "/p/./x/tuned.toml"), one);
  EXPECT_EQ(moved_text(one, "/p/x/axis.toml", "-"), one);
  EXPECT_EQ(moved_text("[drive]\neds = \"/s/a.eds\"\n", "/p/x/axis.toml", "/q/axis.toml"),
            "[drive]\neds = \"/s/a.eds\"\n");
  const std::string two = "[[axis]]\nname = \"a\"\ndrive = { eds = \"../s.eds\" }\n[[axis]]\nname = \"b\"\n";
  EXPECT_EQ(moved_text(two, "/p/x/axis.toml", "/p/axis.toml"),
            "[[axis]]\nname = \"a\"\ndrive = { eds = 's.eds' }\n[[axis]]\nname = \"b\"\n");
}

TEST(EditedFile, IsWrittenAnewWhereAKeyHasNoPlace) {
  const std::string anew = set("a.x = 1 # dotted\nb = 2\n", {"a", "z", "3"});
  EXPECT_EQ(anew.find("dotted"), std::string::npos);
  EXPECT_EQ(set(anew, {"a", "z", "3"}), anew);
}

TEST(EditedFile, IsReadAsTheAxisThatWasMeant) {
  const std::string text = new_node({12, 15, 28, 5e-7, 1000, 200, 0.4}).text;
  const std::string tuned = with_settings(text, "axis.toml", "",
                                          {{"controller", "max_approach_speed_m_s", "1.5"},
                                           {"move", "distance_m", "0.4"},
                                           {"move", "speed_m_s", "1"},
                                           {"move", "acceleration_m_s2", "9"}});
  const Node node = parse_node(tuned, "axis.toml");
  EXPECT_EQ(node.axes.front().controller.max_approach_speed_m_s, 1.5);
  EXPECT_EQ(node.axes.front().move->acceleration_m_s2, 9);
  EXPECT_NE(tuned.find("# lower it where the machine asks for it"), std::string::npos);
}

}  // namespace
}  // namespace breakaway::config

// A file of a node in which some keys are set anew.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace breakaway::config {

// `[table] key = value`, the value as TOML has it. A table within another, which the file must have, has a dot.
struct Setting {
  std::string table, key, value;
};

// Returns the text with these settings: those of [loop], [bus] and [run] at the top, the others in the tables of the
// axis of this name. A file without [[axis]] has one axis, whatever the name; an empty name is that of the first one.
// Every other character of the text stays, comments and order too, but in a file whose tables are spelt so that a key
// cannot be put in place: that is written anew, without its comments. `file` stands for it in errors. Requires a text
// that parse_node() takes; throws InputError where no axis has the name.
std::string with_settings(std::string_view text, const std::string& file, const std::string& axis,
                          const std::vector<Setting>& settings);

// Returns the text of the file `from` as it is to stand in the file `to`: what a path of [drive] eds names from the one
// folder, it names from the other. Standard output, "-", has no folder, and leaves the text as it is. Requires a text
// that parse_node() takes.
std::string moved_text(std::string_view text, const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace breakaway::config

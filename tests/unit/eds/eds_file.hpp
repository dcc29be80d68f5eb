// An EDS as a stranger reads it: sections of keys and values, and nothing of what wrote it.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace breakaway::eds {

using Section = std::map<std::string, std::string>;

struct Entry {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  Section keys;

  unsigned type() const { return static_cast<unsigned>(std::stoul(keys.at("DataType"), nullptr, 0)); }
  bool is_text() const { return type() == 9; }
  std::size_t size() const {
    const std::map<unsigned, std::size_t> sizes{{2, 1}, {3, 2}, {4, 4}, {5, 1}, {6, 2}, {7, 4}, {8, 4}, {9, 0}};
    return sizes.at(type());
  }
  std::string access() const { return keys.at("AccessType"); }
  std::optional<std::string> text(const std::string& key) const {
    const auto found = keys.find(key);
    return found == keys.end() ? std::nullopt : std::optional{found->second};
  }
  // Of a number, under a node id.
  std::optional<std::int64_t> number(const std::string& key, std::uint8_t node_id) const {
    const auto value = text(key);
    if (!value) return {};
    const std::string sum = "$NODEID+";
    if (value->rfind(sum, 0) == 0) return node_id + std::stoll(value->substr(sum.size()), nullptr, 0);
    return std::stoll(*value, nullptr, 0);
  }
  std::string name() const {
    std::ostringstream text;
    text << std::hex << index << ':' << int{sub};
    return text.str();
  }
};

class EdsFile {
 public:
  explicit EdsFile(const std::string& text) {
    std::istringstream lines{text};
    std::string section;
    for (std::string line; std::getline(lines, line);) {
      if (line.empty()) continue;
      if (line.front() == '[') {
        section = line.substr(1, line.size() - 2);
        EXPECT_FALSE(sections.contains(section)) << section << " is there twice";
        sections[section];
        continue;
      }
      const auto equals = line.find('=');
      EXPECT_NE(equals, std::string::npos) << line;
      if (equals == std::string::npos) continue;
      EXPECT_TRUE(sections[section].emplace(line.substr(0, equals), line.substr(equals + 1)).second) << line;
    }
  }

  // All that have a value: objects without sub-indices, and sub-indices.
  std::vector<Entry> entries() const {
    std::vector<Entry> found;
    for (const auto& [name, keys] : sections) {
      if (name.find_first_not_of("0123456789ABCDEFsub") != std::string::npos || !keys.contains("DataType")) continue;
      const auto index = static_cast<std::uint16_t>(std::stoul(name.substr(0, 4), nullptr, 16));
      const bool is_sub = name.size() > 4;
      const auto sub = static_cast<std::uint8_t>(is_sub ? std::stoul(name.substr(7), nullptr, 16) : 0);
      found.push_back({index, sub, keys});
    }
    return found;
  }

  std::map<std::string, Section> sections;
};

}  // namespace breakaway::eds

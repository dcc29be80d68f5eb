// Where the world that a file describes is not the one that a certificate is of.
#pragma once

#include <string>
#include <vector>

#include "breakaway/config/node.hpp"

namespace breakaway::config {

// What the file says that is outside the class of axes that a certificate of this one would be of, each in a sentence
// with its remedy. Empty: nothing.
std::vector<std::string> outside_class(const Node& node, const Axis& axis);

// Says that the answer of a drive with SYNC comes too late for the period of its sample; nothing where it does not.
// Requires node.loop and its bit_rate.
std::string late_answer(const Node& node, const Axis& axis);

}  // namespace breakaway::config

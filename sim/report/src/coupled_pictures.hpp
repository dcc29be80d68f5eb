// The pictures of axes that push each other, which no axis has for itself.
#pragma once

#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/sil/result.hpp"
#include "pictures.hpp"

namespace breakaway::report {

// Which axis is kicked when; and each axis' error over that of the one before it in the file, with the box and the set
// in which the certificate has them rest. Requires node.coupling and a recorded trace of every axis.
std::vector<Picture> draw_coupled_pictures(const config::Node& node, const sil::Result& result);

}  // namespace breakaway::report

// The text of an electronic data sheet (EDS, CiA 306).
#pragma once

#include <chrono>
#include <string>

#include "breakaway/eds/device.hpp"

namespace breakaway::eds {

// file_name: the name under which it is kept, without folders. made_at: its date, shown in UTC.
// Throws std::out_of_range for an object that object_names.hpp does not know.
std::string to_eds(const Device& device, const std::string& file_name, std::chrono::system_clock::time_point made_at);

}  // namespace breakaway::eds

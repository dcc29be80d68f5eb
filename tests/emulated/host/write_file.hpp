// A file of items as they lie in memory.
#pragma once

#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace breakaway::emulated {

template <class Item>
void write_file(const std::string& path, const std::vector<Item>& items) {
  std::ofstream file{path, std::ios::binary};
  file.write(reinterpret_cast<const char*>(items.data()), static_cast<std::streamsize>(items.size() * sizeof(Item)));
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace breakaway::emulated

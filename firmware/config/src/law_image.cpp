#include "breakaway/firmware/law_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <iterator>
#include <type_traits>
#include <utility>

#include "breakaway/config/flash.hpp"
#include "one_line.hpp"

namespace breakaway::config {
namespace {

class LawImageWriter {
 public:
  template <class T>
  void value(const char*, const T& number, const char* = "") {
    if constexpr (std::is_floating_point_v<T>) {
      put(std::bit_cast<std::uint32_t>(static_cast<float>(number)), 4);
    } else if constexpr (std::is_same_v<T, firmware::AxisName>) {
      for (const char c : number.characters) put(static_cast<std::uint8_t>(c), 1);
    } else {
      put(static_cast<std::uint64_t>(number), sizeof(T));
    }
  }
  template <class Body>
  void group(const char*, const Body& body) {
    body();
  }
  template <class Items, class Body>
  void list(const char*, const Items& items, const Body& body) {
    for (const auto& item : items) body(item);
  }
  template <class Items>
  void row(const char*, const Items& items) {
    for (const auto& item : items) value("", item);
  }

  void put(std::uint64_t bits, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i) bytes_.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
  }
  std::vector<std::uint8_t>& bytes() { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

template <class Flashed>
std::vector<std::uint8_t> image_of(const Flashed& node, firmware::LawImageKind kind) {
  LawImageWriter image;
  for (const std::uint8_t byte : firmware::law_image_magic) image.put(byte, 1);
  image.put(firmware::law_image_version, 1);
  image.put(static_cast<std::uint8_t>(kind), 1);
  image.put(node.count, 1);
  image.put(0, 1);
  for (const auto& axis : present_axes(node)) {
    LawImageWriter numbers;
    numbers.put(axis.kicks.table.count, 1);
    visit_law_numbers(axis, numbers);
    image.put(numbers.bytes().size(), 4);
    std::ranges::copy(numbers.bytes(), std::back_inserter(image.bytes()));
  }
  image.put(firmware::checksum_of_bytes(image.bytes()), firmware::law_image_checksum_bytes);
  return std::move(image.bytes());
}

}  // namespace

std::vector<std::uint8_t> law_image(const AnyNode<float>& flashed) {
  return image_of(flashed, firmware::LawImageKind::rigid);
}
std::vector<std::uint8_t> law_image(const WorkNode<float>& flashed) {
  return image_of(flashed, firmware::LawImageKind::by_work);
}

std::string law_image_header(const std::vector<std::uint8_t>& image, const std::string& from) {
  std::string text = fmt::format(
      "/* The law image of {}, for breakaway/law.h. Written by `breakaway design --law-image`; do not edit. */\n"
      "#ifndef BREAKAWAY_LAW_IMAGE_H\n#define BREAKAWAY_LAW_IMAGE_H\n\n"
      "static const unsigned char breakaway_law_image[{}] = {{",
      in_one_line(from), image.size());
  constexpr std::size_t a_line = 20;
  for (std::size_t i = 0; i < image.size(); ++i) text += fmt::format("{}{},", i % a_line == 0 ? "\n  " : " ", image[i]);
  return text + "\n};\n\n#endif\n";
}

}  // namespace breakaway::config

// Every key that a file may hold, and where the certificate of an axis stands to it.
//
// A certificate takes in everything that the file says, or is refused: a key that is not in this list is refused by
// name, so that a new one cannot be forgotten.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace breakaway::config {

enum class Standing : std::uint8_t {
  counted,  // a number of the node that the checks count with
  bounded,  // of the world: certified while it stays within what the node is told
  refused,  // of the world: outside what is certified
  apart,    // says nothing of whether an axis comes to rest on its target, or how
};

struct CertificateKey {
  std::string_view table, key;
  Standing standing;
  std::string_view remedy{};  // where it is refused
};

std::span<const CertificateKey> certificate_keys();

}  // namespace breakaway::config

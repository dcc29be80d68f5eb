// SDO server (CiA 301, 7.2.4): expedited and segmented transfers in both directions; block transfer is refused.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "breakaway/drive_emulator/object_dictionary.hpp"

namespace breakaway::drive_emulator {

class SdoServer {
 public:
  using Payload = std::array<std::uint8_t, 8>;

  // `dictionary` must outlive the server.
  explicit SdoServer(ObjectDictionary& dictionary) : dictionary_(dictionary) {}

  // What the server answers to a request; nothing when the client aborted.
  std::optional<Payload> answer(const Payload& request);

  bool transfer_under_way() const { return direction_ != Direction::none; }  // segmented, between two frames
  Payload abort(canopen::SdoAbort code);                                     // ends the transfer under way, if any
  void reset() { direction_ = Direction::none; }

 private:
  enum class Direction : std::uint8_t { none, upload, download };

  Payload begin_upload();
  Payload upload_segment(const Payload& request);
  Payload begin_download(const Payload& request);
  Payload download_segment(const Payload& request);
  Payload store();
  Payload begin_segmented(Direction direction, std::uint32_t size);
  Payload reply(unsigned command) const;

  ObjectDictionary& dictionary_;
  Address address_{};
  Direction direction_ = Direction::none;
  bool toggle_ = false;  // the toggle bit that the next segment must carry
  ObjectDictionary::Bytes data_;
  std::size_t done_bytes_ = 0;                    // upload: sent so far
  std::optional<std::uint32_t> announced_bytes_;  // download: what the client said that it will send
};

}  // namespace breakaway::drive_emulator

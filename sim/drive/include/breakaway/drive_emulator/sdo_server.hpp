// SdoServer: answers SDO requests (CiA 301, 7.2.4), expedited and segmented in both directions. Block transfer is
// refused.
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

  // Returns the server's answer to a request; nothing when the client aborted.
  std::optional<Payload> answer(const Payload& request);

  // Returns the refusal of a request, whatever it asks; nothing when the client aborted.
  std::optional<Payload> refuse(const Payload& request, canopen::SdoAbort code);

  // Returns true between two frames of a segmented transfer.
  bool transfer_under_way() const { return direction_ != Direction::none; }
  // Ends the transfer that is under way, if any, and returns the frame that tells the client.
  Payload abort(canopen::SdoAbort code);
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
  std::optional<std::uint32_t> announced_bytes_;  // download: as many as the client said that it will send
};

}  // namespace breakaway::drive_emulator

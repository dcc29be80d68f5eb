// SDO client (CiA 301, 7.2.4): reads and writes one node's objects, expedited or segmented, without ever blocking.
//
//   client.start_read(0x1000, 0);
//   each period: give every frame to on_frame, send what next_frame hands out, and ask poll(now) until it is not
//   would_block.
//
// A response is taken only while a request waits for one, and only if it can belong to it: what arrives late, twice, or
// for another object is passed over.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "breakaway/canopen/sdo_abort.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/status.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::canopen {

class SdoClient {
 public:
  static constexpr std::size_t capacity = 64;  // bytes of the longest object

  // node_id: 1..127, the server's. timeout: above 0, for every single response.
  SdoClient(std::uint8_t node_id, hal::Duration timeout) noexcept;

  // ok; would_block: the last transfer is not finished.
  hal::Status start_read(std::uint16_t index, std::uint8_t subindex) noexcept;
  // bytes: 1..capacity of them, else invalid_argument. They are copied.
  hal::Status start_write(std::uint16_t index, std::uint8_t subindex, std::span<const std::uint8_t> bytes) noexcept;

  void on_frame(const hal::CanFrame& frame) noexcept;

  // True, with the frame, when one is to be sent; it must then be sent. Its response is awaited from `now` on.
  bool next_frame(hal::CanFrame& frame, hal::Time now) noexcept;

  // would_block until the transfer is finished, then how it ended, until the next start: ok, timeout, sdo_aborted
  // (detail: the abort code; out_of_memory is our own, for an object longer than capacity), protocol_error (detail:
  // the command byte that came). Before the first transfer: ok.
  hal::Status poll(hal::Time now) noexcept;

  bool busy() const noexcept { return phase_ != Phase::idle; }
  // What the last read brought, when poll says ok.
  std::span<const std::uint8_t> data() const noexcept { return std::span{buffer_}.first(size_); }
  // Forgets the transfer without a word to the server, for a node that rebooted.
  void cancel() noexcept;

 private:
  enum class Phase : std::uint8_t { idle, initiate_read, read_segments, initiate_write, write_segments };

  void begin(Phase phase, std::uint16_t index, std::uint8_t subindex) noexcept;
  void request_initiate_read() noexcept;
  void request_initiate_write() noexcept;
  void request_read_segment() noexcept;
  void request_write_segment() noexcept;
  void request(const std::array<std::uint8_t, 8>& bytes) noexcept;
  bool names_object(const hal::CanFrame& frame) const noexcept;

  void on_initiate_read(const hal::CanFrame& frame) noexcept;
  void on_initiate_write(const hal::CanFrame& frame) noexcept;
  void on_read_segment(const hal::CanFrame& frame) noexcept;
  void on_write_segment(const hal::CanFrame& frame) noexcept;

  void finish(hal::Status result) noexcept;
  void abort(SdoAbort code, hal::Status result) noexcept;

  std::uint8_t node_id_;
  hal::Duration timeout_;
  Phase phase_ = Phase::idle;
  hal::Status result_;
  std::uint16_t index_ = 0;
  std::uint8_t subindex_ = 0;
  std::array<std::uint8_t, capacity> buffer_{};
  std::size_t size_ = 0;       // bytes in the buffer
  std::size_t announced_ = 0;  // by the server, for a segmented read; 0: it did not say
  std::size_t sent_ = 0;       // bytes of the buffer in segments so far
  bool toggle_ = false;        // of the segment that is asked for or sent
  bool last_segment_ = false;

  hal::CanFrame request_{};
  bool request_pending_ = false;  // to be handed out by next_frame
  bool awaiting_ = false;         // handed out, no response yet
  hal::Time sent_at_{};
  hal::CanFrame abort_{};
  bool abort_pending_ = false;
};

}  // namespace breakaway::canopen

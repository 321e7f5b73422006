#pragma once
/// The client of one node's SDO server: one transfer at a time, repeated if no answer comes. Pure: `now` and frames in,
/// frames out.

#include <deque>
#include <optional>
#include <tl/expected.hpp>
#include <vector>

#include "core/time.h"
#include "drivers/can/can_frame.h"
#include "drivers/can/canopen/sdo_codec.h"

namespace luxrig::canopen {

/// With a value (1 to 4 bytes, little-endian) a write, else a read.
struct SdoRequest {
  ObjectAddress object;
  std::vector<std::uint8_t> value;
};

struct SdoFailure {
  std::optional<std::uint32_t> abort_code;  ///< from the node; empty = no answer
};
/// The value read; empty after a write.
using SdoResult = tl::expected<std::vector<std::uint8_t>, SdoFailure>;

class SdoClient {
 public:
  static constexpr Duration kAnswerTimeout = std::chrono::milliseconds(500);
  static constexpr int kRetries = 2;
  static constexpr std::size_t kLongestValue = 1024;  ///< of a segmented read; a longer one is aborted

  explicit SdoClient(int node) : node_(node) {}

  [[nodiscard]] bool idle() const { return !request_; }
  void start(SdoRequest request);  ///< requires idle()
  void cancel() { request_.reset(), result_.reset(); }

  /// The frame to send now: the request, its repetition, or the next segment. Empty while waiting for the answer.
  [[nodiscard]] std::optional<can::CanFrame> to_send(Time now);
  /// A frame from the node's server (0x580 + node). Ignores a late or garbled answer that does not belong to the
  /// transfer.
  void receive(const can::CanFrame& frame);
  /// The result, once, after the transfer has ended.
  [[nodiscard]] std::optional<SdoResult> take_result();

 private:
  [[nodiscard]] can::CanFrame frame_of(const SdoBytes& bytes) const;
  void end(SdoResult result);
  void take_segment(const SdoAnswer& answer);

  int node_;
  std::optional<SdoRequest> request_;
  std::optional<SdoResult> result_;
  std::optional<SdoBytes> due_;      ///< to be sent next
  std::optional<SdoBytes> parting_;  ///< our abort, sent after the transfer has ended
  Time sent_{};
  int tries_ = 0;
  bool in_segments_ = false, toggle_ = false;
  std::vector<std::uint8_t> read_;
};

}  // namespace luxrig::canopen

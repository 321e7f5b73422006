#pragma once
/// The client of one node's SDO server: one transfer at a time, repeated when no answer comes. Pure: `now` and frames
/// in, frames out.

#include <deque>
#include <optional>
#include <tl/expected.hpp>
#include <vector>

#include "core/time.h"
#include "drivers/can/can_frame.h"
#include "drivers/can/canopen/sdo_codec.h"

namespace luxrig::canopen {

/// A write when there is a value (1 to 4 bytes, little-endian), else a read.
struct SdoRequest {
  ObjectAddress object;
  std::vector<std::uint8_t> value;
};

struct SdoFailure {
  std::optional<std::uint32_t> abort_code;  ///< of the node; none: no answer
};
/// What was read; empty after a write.
using SdoResult = tl::expected<std::vector<std::uint8_t>, SdoFailure>;

class SdoClient {
 public:
  static constexpr Duration kAnswerTimeout = std::chrono::milliseconds(500);
  static constexpr int kRetries = 2;
  static constexpr std::size_t kLongestValue = 1024;  ///< of a segmented read; what is longer is aborted

  explicit SdoClient(int node) : node_(node) {}

  [[nodiscard]] bool idle() const { return !request_; }
  void start(SdoRequest request);  ///< requires idle()
  void cancel() { request_.reset(), result_.reset(); }

  /// What to send now: the request, its repetition, the next segment; nothing while the answer is awaited.
  [[nodiscard]] std::optional<can::CanFrame> to_send(Time now);
  /// A frame from the node's server (0x580 + node). One that does not belong to the transfer is ignored: an answer that
  /// came too late, or a garbled one.
  void receive(const can::CanFrame& frame);
  /// Once, when the transfer has ended.
  [[nodiscard]] std::optional<SdoResult> take_result();

 private:
  [[nodiscard]] can::CanFrame frame_of(const SdoBytes& bytes) const;
  void end(SdoResult result);
  void take_segment(const SdoAnswer& answer);

  int node_;
  std::optional<SdoRequest> request_;
  std::optional<SdoResult> result_;
  std::optional<SdoBytes> due_;      ///< to be sent next
  std::optional<SdoBytes> parting_;  ///< an abort of ours, behind the transfer's end
  Time sent_{};
  int tries_ = 0;
  bool in_segments_ = false, toggle_ = false;
  std::vector<std::uint8_t> read_;
};

}  // namespace luxrig::canopen

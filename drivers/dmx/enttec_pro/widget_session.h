#pragma once
/// What is said to an ENTTEC DMX USB Pro when, and what its answers mean. No I/O: `now` and bytes in, bytes out.
///
/// First it asks who is there (parameters, serial number, names); any request but 6 and 3 stops the widget's output, so
/// that is never asked again. Then it is live: levels when they change, at most `rate_hz` times a second, and every
/// 0.9 s; parameters four times a second, to see that the widget is there, as label 6 has no answer.

#include <optional>
#include <string>
#include <vector>

#include "drivers/dmx/enttec_pro/enttec_codec.h"
#include "drivers/dmx/send_rate.h"

namespace luxrig::enttec {

struct Identity {
  std::string serial, manufacturer, device_name;  ///< empty: not said
  int firmware = 0;
};

class WidgetSession {
 public:
  /// `wanted.firmware` does not count.
  explicit WidgetSession(const Parameters& wanted) : wanted_(wanted) {}

  /// A widget has been plugged in, and nothing is known of it.
  void start(Time now);
  void receive(Time now, std::span<const std::uint8_t> bytes);
  /// What to send now; perhaps nothing. requires start().
  [[nodiscard]] std::vector<std::uint8_t> due(Time now, const DmxSlots& slots);
  /// Levels that have not been sent yet, whatever the rate says: before leaving. Empty while it is not live.
  [[nodiscard]] std::vector<std::uint8_t> unsent(const DmxSlots& slots);

  [[nodiscard]] bool is_sent(const DmxSlots& slots) const { return live_ && sent_ == slots; }

  /// Whether levels go out.
  [[nodiscard]] bool is_live() const { return live_; }
  /// A question has waited for its answer for longer than 500 ms.
  [[nodiscard]] bool is_overdue(Time now) const;
  [[nodiscard]] bool has_answered() const { return has_answered_; }
  [[nodiscard]] const Identity& identity() const { return identity_; }
  [[nodiscard]] std::uint64_t answers() const { return answers_; }

  static constexpr Duration kAnswerWithin = std::chrono::milliseconds(500);

 private:
  void understand(Time now, const Message& message);
  void go_live_if_ready(Time now);

  Parameters wanted_;
  StreamDecoder decoder_;
  Identity identity_;
  Time started_{}, asked_{}, received_at_{};
  bool asking_ = false, has_answered_ = false, live_ = false;
  bool parameters_known_ = false, serial_known_ = false, names_known_ = false, device_known_ = false;
  std::uint64_t answers_ = 0;
  SendRate rate_;
  std::optional<DmxSlots> sent_;
  Time sent_at_{};
  std::vector<std::uint8_t> queued_;
};

}  // namespace luxrig::enttec

#pragma once
/// The dialogue with an ENTTEC DMX USB Pro: what to send when, and what its answers mean. No I/O: `now` and bytes in,
/// bytes out.
///
/// First it identifies the widget (parameters, serial number, names). Any request but 6 and 3 stops the widget's
/// output, so these are never repeated. Then it is live. It sends levels on change, at most `rate_hz` times a second,
/// and every 0.9 s. Label 6 has no answer, so it asks for parameters four times a second to see that the widget is
/// there.

#include <optional>
#include <string>
#include <vector>

#include "drivers/dmx/enttec_pro/enttec_codec.h"
#include "drivers/dmx/send_rate.h"

namespace luxrig::enttec {

struct Identity {
  std::string serial, manufacturer, device_name;  ///< empty = not reported
  int firmware = 0;
};

class WidgetSession {
 public:
  /// `wanted.firmware` is ignored.
  explicit WidgetSession(const Parameters& wanted) : wanted_(wanted) {}

  /// For a newly plugged-in widget: forgets everything.
  void start(Time now);
  void receive(Time now, std::span<const std::uint8_t> bytes);
  /// Bytes to send now; may be empty. requires start().
  [[nodiscard]] std::vector<std::uint8_t> due(Time now, const DmxSlots& slots);
  /// Levels not sent yet, regardless of the rate; for use before closing. Empty while it is not live.
  [[nodiscard]] std::vector<std::uint8_t> unsent(const DmxSlots& slots);

  [[nodiscard]] bool is_sent(const DmxSlots& slots) const { return live_ && sent_ == slots; }

  /// Whether levels are sent.
  [[nodiscard]] bool is_live() const { return live_; }
  /// A request has waited longer than 500 ms for its answer.
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

#include "drivers/dmx/enttec_pro/widget_session.h"

namespace luxrig::enttec {
namespace {

using std::chrono::milliseconds;

// Original widgets never report their names, and some clones no serial number.
constexpr Duration kIdentifyWithin = milliseconds(200);
constexpr Duration kAskEvery = milliseconds(250), kRepeatEvery = milliseconds(900);
constexpr Duration kPauseWithin = milliseconds(100);  // within a message; a widget sends it in one go

void append(std::vector<std::uint8_t>& to, const std::vector<std::uint8_t>& bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

std::vector<std::uint8_t> parameters_request() {
  constexpr std::uint8_t kNoUserData[] = {0, 0};
  return encode(Label::get_parameters, kNoUserData);
}

}  // namespace

void WidgetSession::start(Time now) {
  const Parameters wanted = wanted_;
  *this = WidgetSession(wanted);
  rate_ = SendRate(std::chrono::nanoseconds(1'000'000'000 / wanted.rate_hz));
  started_ = asked_ = now;
  asking_ = true;
  queued_ = parameters_request();
  for (const Label label : {Label::serial_number, Label::manufacturer, Label::device_name}) {
    append(queued_, encode(label, {}));
  }
}

void WidgetSession::receive(Time now, std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return;
  // A garbled length may ask for more bytes than the widget sends in many seconds.
  if (now - received_at_ > kPauseWithin) decoder_.give_up();
  received_at_ = now;
  decoder_.add(bytes);
  while (const auto message = decoder_.next()) understand(now, *message);
}

void WidgetSession::understand(Time now, const Message& message) {
  switch (static_cast<Label>(message.label)) {
    case Label::get_parameters: {
      const auto parameters = decode_parameters(message.data);
      if (!parameters) return;
      asking_ = false;
      has_answered_ = true;
      ++answers_;
      identity_.firmware = parameters->firmware;
      if (!parameters_known_ &&
          (parameters->break_units != wanted_.break_units || parameters->mark_units != wanted_.mark_units ||
           parameters->rate_hz != wanted_.rate_hz)) {
        append(queued_, encode_set_parameters(wanted_));
      }
      parameters_known_ = true;
      break;
    }
    case Label::serial_number:
      if (const auto serial = decode_serial(message.data)) identity_.serial = *serial;
      serial_known_ = true;
      break;
    case Label::manufacturer:
      identity_.manufacturer = decode_name(message.data).value_or("");
      names_known_ = true;
      break;
    case Label::device_name:
      identity_.device_name = decode_name(message.data).value_or("");
      device_known_ = true;
      break;
    default:
      return;  // unexpected
  }
  go_live_if_ready(now);
}

void WidgetSession::go_live_if_ready(Time now) {
  if (!parameters_known_) return;
  if ((serial_known_ && names_known_ && device_known_) || now - started_ >= kIdentifyWithin) live_ = true;
}

std::vector<std::uint8_t> WidgetSession::due(Time now, const DmxSlots& slots) {
  go_live_if_ready(now);
  std::vector<std::uint8_t> bytes;
  bytes.swap(queued_);
  if (!bytes.empty()) sent_.reset();  // a request that stops the widget's output is followed by the levels
  if (!live_) return bytes;
  const bool wanted = !sent_ || *sent_ != slots || now - sent_at_ >= kRepeatEvery;
  if (wanted && rate_.take(now)) {
    append(bytes, encode_output(slots));
    sent_ = slots;
    sent_at_ = now;
  }
  if (!asking_ && now - asked_ >= kAskEvery) {
    append(bytes, parameters_request());
    asked_ = now;
    asking_ = true;
  }
  return bytes;
}

std::vector<std::uint8_t> WidgetSession::unsent(const DmxSlots& slots) {
  if (!live_ || (sent_ && *sent_ == slots)) return {};
  sent_ = slots;
  return encode_output(slots);
}

bool WidgetSession::is_overdue(Time now) const { return asking_ && now - asked_ > kAnswerWithin; }

}  // namespace luxrig::enttec

#include "drivers/dmx/enttec_pro/widget_rdm.h"

#include <fmt/format.h>

#include "drivers/dmx/usb/ftdi.h"
#include "drivers/io/deadline.h"

namespace luxrig::enttec {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kSaidWithin(200), kKnownWithin(600), kAnsweredWithin(150), kListenStep(20);
constexpr int kChipBaud = 57600, kChipLatency_ms = 2;
constexpr std::size_t kReadBytes = 512;
constexpr ftdi::Port kChipPort{};

bool is_answer(const Message& message) {
  return message.label == static_cast<std::uint8_t>(Label::received_dmx) ||
         message.label == static_cast<std::uint8_t>(Label::rdm_timeout);
}

/// Bytes received from the line. A status byte precedes them; its bits report losses.
std::vector<std::uint8_t> bytes_of(const Message& message) {
  if (message.label != static_cast<std::uint8_t>(Label::received_dmx) || message.data.empty()) return {};
  return {message.data.begin() + 1, message.data.end()};
}

Fault network_fault(const UsbCompletion& completion) {
  const bool gone = completion.status == UsbStatus::gone;
  return {Cause::network,
          {},
          gone ? "the widget has been unplugged: plug it in again"
               : fmt::format("a transfer {}: the cable or a hub is bad", name_of(completion.status)),
          {}};
}

}  // namespace

WidgetRdm::WidgetRdm(std::unique_ptr<UsbChannel> channel, const rdm::Uid& controller)
    : channel_(std::move(channel)), controller_(controller) {}

WidgetRdm::~WidgetRdm() { channel_->close(); }

Result<void> WidgetRdm::open() {
  if (auto opened = channel_->open(); !opened) return opened;
  for (const UsbSetup& request :
       {ftdi::reset(kChipPort, ftdi::Purge::reset), ftdi::set_baud(kChipPort, kChipBaud),
        ftdi::set_format(kChipPort, ftdi::Format::eight_n_one), ftdi::no_flow_control(kChipPort),
        ftdi::set_latency(kChipPort, kChipLatency_ms), ftdi::reset(kChipPort, ftdi::Purge::receive)}) {
    channel_->control_out(request, {});
    const auto completion = channel_->take(kSaidWithin);
    if (!completion) {
      return tl::unexpected(
          Fault{Cause::timeout, {}, "no answer to a control request: unplug the widget and plug it in again", {}});
    }
    if (completion->status != UsbStatus::done) return tl::unexpected(network_fault(*completion));
  }
  receiving_ = channel_->bulk_in(kChipPort.bulk_in(), kReadBytes);
  constexpr std::uint8_t kNoUserData[] = {0, 0};
  if (auto said = say(Label::get_parameters, kNoUserData); !said) return said;
  for (const Deadline deadline(kKnownWithin); !deadline.passed();) {
    if (auto listened = listen(kListenStep); !listened) return listened;
    while (!heard_.empty()) {
      const Message message = std::move(heard_.front());
      heard_.pop_front();
      if (message.label != static_cast<std::uint8_t>(Label::get_parameters)) continue;
      if (const auto parameters = decode_parameters(message.data)) {
        firmware_ = parameters->firmware;
        return {};
      }
    }
  }
  return tl::unexpected(Fault{Cause::timeout,
                              {},
                              "nothing there answers as an ENTTEC DMX USB Pro does: a plain cable has no RDM; of "
                              "several widgets name the serial number",
                              {}});
}

Result<void> WidgetRdm::say(Label label, std::span<const std::uint8_t> data) {
  const UsbTicket ticket = channel_->bulk_out(kChipPort.bulk_out(), encode(label, data));
  for (const Deadline deadline(kSaidWithin); !deadline.passed();) {
    const auto completion = channel_->take(deadline.left());
    if (!completion) break;
    if (completion->status != UsbStatus::done) return tl::unexpected(network_fault(*completion));
    if (completion->ticket == ticket) return {};
    if (receiving_ == completion->ticket) {
      decoder_.add(ftdi::received_bytes(completion->data));
      receiving_ = channel_->bulk_in(kChipPort.bulk_in(), kReadBytes);
    }
  }
  return tl::unexpected(
      Fault{Cause::timeout, {}, "the widget takes no more requests: unplug it and plug it in again", {}});
}

Result<void> WidgetRdm::listen(milliseconds wait) {
  if (const auto completion = channel_->take(wait)) {
    if (completion->status != UsbStatus::done) return tl::unexpected(network_fault(*completion));
    if (receiving_ == completion->ticket) {
      decoder_.add(ftdi::received_bytes(completion->data));
      receiving_ = channel_->bulk_in(kChipPort.bulk_in(), kReadBytes);
    }
  }
  while (auto message = decoder_.next()) heard_.push_back(std::move(*message));
  return {};
}

Result<std::optional<Message>> WidgetRdm::next_answer() {
  for (const Deadline deadline(kAnsweredWithin);;) {
    while (!heard_.empty()) {
      Message message = std::move(heard_.front());
      heard_.pop_front();
      if (is_answer(message)) return message;
    }
    if (deadline.passed()) {
      decoder_.give_up();  // the rest of a begun message is lost
      return std::optional<Message>();
    }
    if (auto listened = listen(deadline.left()); !listened) return tl::unexpected(listened.error());
  }
}

void WidgetRdm::forget() {
  heard_.clear();
  while (decoder_.next()) {
  }
}

Result<void> WidgetRdm::send(Time, std::span<const std::uint8_t> packet) {
  forget();
  return say(Label::send_rdm, packet);
}

std::optional<std::vector<std::uint8_t>> WidgetRdm::receive(Time) {
  if (heard_.empty() && !listen(milliseconds(0))) return std::nullopt;
  while (!heard_.empty()) {
    const Message message = std::move(heard_.front());
    heard_.pop_front();
    if (auto bytes = bytes_of(message); !bytes.empty()) return bytes;
  }
  return std::nullopt;
}

Result<void> WidgetRdm::un_mute_everybody() {
  if (auto sent = send({}, rdm::encode(rdm::un_mute_request(controller_, number_++))); !sent) return sent;
  // No device answers, and not every widget reports that.
  if (auto none = next_answer(); !none) return tl::unexpected(none.error());
  return {};
}

Result<std::vector<std::uint8_t>> WidgetRdm::ask_branch(const rdm::Uid& lowest, const rdm::Uid& highest) {
  forget();
  const auto packet = rdm::encode(rdm::unique_branch_request(controller_, number_++, lowest, highest));
  if (auto said = say(Label::send_rdm_discovery, packet); !said) return tl::unexpected(said.error());
  const auto answer = next_answer();
  if (!answer) return tl::unexpected(answer.error());
  return *answer ? bytes_of(**answer) : std::vector<std::uint8_t>{};
}

Result<bool> WidgetRdm::mute(const rdm::Uid& who) {
  const std::uint8_t number = number_++;
  if (auto sent = send({}, rdm::encode(rdm::mute_request(controller_, number, who))); !sent)
    return tl::unexpected(sent.error());
  const auto answer = next_answer();
  if (!answer) return tl::unexpected(answer.error());
  if (!*answer) return false;
  const auto packet = rdm::decode(bytes_of(**answer));
  return packet && packet->from == who && packet->to == controller_ && packet->transaction == number &&
         packet->command_class == rdm::CommandClass::discovery_response && packet->pid == rdm::Pid::disc_mute;
}

}  // namespace luxrig::enttec

#pragma once
/// RDM on the line of an ENTTEC DMX USB Pro or compatible widget: requests for rdm::Client, and discovery. Source:
/// ENTTEC, DMX USB Pro Widget API Specification 1.44: labels 7 and 11, answers 5 and 12.
///
/// It waits in real time and uses the widget alone, which sends no levels during that. So it is for tools, not for a
/// bus that lights lamps.

#include <deque>
#include <memory>
#include <vector>

#include "drivers/dmx/enttec_pro/enttec_codec.h"
#include "drivers/dmx/rdm/rdm_client.h"
#include "drivers/dmx/rdm/rdm_discovery.h"
#include "drivers/usb/usb_channel.h"

namespace luxrig::enttec {

class WidgetRdm final : public rdm::RdmLink, public rdm::DiscoveryLine {
 public:
  /// `controller`: UID of the requester. The channel is not open yet.
  WidgetRdm(std::unique_ptr<UsbChannel> channel, const rdm::Uid& controller);
  ~WidgetRdm() override;

  /// Claims the widget and asks for its identity; takes a second at most. Faults as UsbChannel::open, and timeout if
  /// nothing answers like such a widget.
  Result<void> open();
  [[nodiscard]] std::string where() const { return channel_->where(); }
  [[nodiscard]] int firmware() const { return firmware_; }  ///< 0x0204: 2.4
  /// ENTTEC's own widgets support RDM from firmware 2 on, which must be loaded separately.
  [[nodiscard]] bool may_lack_rdm() const { return firmware_ < 0x0200; }

  Result<void> send(Time now, std::span<const std::uint8_t> packet) override;
  std::optional<std::vector<std::uint8_t>> receive(Time now) override;
  [[nodiscard]] Duration answer_within() const override { return std::chrono::milliseconds(200); }

  Result<void> un_mute_everybody() override;
  Result<std::vector<std::uint8_t>> ask_branch(const rdm::Uid& lowest, const rdm::Uid& highest) override;
  Result<bool> mute(const rdm::Uid& who) override;

 private:
  Result<void> say(Label label, std::span<const std::uint8_t> data);
  /// Discards earlier messages, which do not belong to the next request.
  void forget();
  /// Takes received messages; waits for at most `wait`.
  Result<void> listen(std::chrono::milliseconds wait);
  /// The next message that is an answer from the line, or the widget's report that there was none. Empty if neither
  /// came.
  Result<std::optional<Message>> next_answer();

  std::unique_ptr<UsbChannel> channel_;
  rdm::Uid controller_;
  std::uint8_t number_ = 0;
  int firmware_ = 0;
  std::optional<UsbTicket> receiving_;
  StreamDecoder decoder_;
  std::deque<Message> heard_;
};

}  // namespace luxrig::enttec

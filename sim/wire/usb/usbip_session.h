#pragma once
/// A USB/IP server with one device. Pure: bytes and the time come in, bytes go out.
/// Source: Linux, Documentation/usb/usbip_protocol.rst (version 1.1.1).
///
/// Kept: device list, import, submit and unlink of control and bulk transfers. Transfers of one endpoint are done one
/// after the other, each for as long as the device takes. What breaks the protocol breaks the session.
/// It serves luxrig-sim's buses, `usbip attach`, and vhci_hcd in a guest.

#include <deque>
#include <functional>
#include <map>

#include "sim/devices/usb/usb_device.h"
#include "sim/faults/faults.h"

namespace luxrig::sim {

class UsbipSession {
 public:
  /// attached: the other side is vhci_hcd, which begins with transfers.
  enum class Beginning { handshake, attached };
  /// `fault`: what is wrong with a transfer that begins; asked once for each. silent: it hangs until it is unlinked.
  /// delay: it takes longer. exception: it stalls. garbled: control stalls, a byte of what goes in is wrong.
  using FaultOf = std::function<Disturbance()>;
  /// The device outlives it.
  UsbipSession(UsbDevice& device, Beginning beginning, FaultOf fault = {});

  void receive(Time now, std::span<const std::uint8_t> bytes);
  /// Begins and ends what is due.
  void serve(Time now);
  [[nodiscard]] std::vector<std::uint8_t> take_output();
  /// The other side has broken the protocol, or asks for more than fits: hang up.
  [[nodiscard]] bool is_broken() const { return broken_; }
  [[nodiscard]] std::uint64_t begun() const { return begun_; }  ///< transfers that reached the device

 private:
  struct Urb {
    std::uint32_t sequence = 0;
    bool in = false, hangs = false;
    int endpoint = 0;
    UsbControl setup;
    std::size_t length = 0;
    std::vector<std::uint8_t> out;
    std::optional<UsbReply> reply;
    std::optional<Disturbance> disturbance;
    Time due{};
  };

  bool take_operation();
  bool take_command();
  void begin(Time now, Urb& urb);
  void answer(const Urb& urb);
  void unlink(std::uint32_t sequence, std::uint32_t unlinked);
  void put_device(std::vector<std::uint8_t>& into) const;

  UsbDevice& device_;
  FaultOf fault_;
  bool attached_, broken_ = false;
  std::vector<std::uint8_t> heard_, said_;
  std::map<int, std::deque<Urb>> queues_;  ///< by endpoint address
  std::uint64_t begun_ = 0;
};

}  // namespace luxrig::sim

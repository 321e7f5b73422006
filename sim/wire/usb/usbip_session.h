#pragma once
/// A USB/IP server with one device. Pure: bytes and the time in, bytes out.
/// Source: Linux, Documentation/usb/usbip_protocol.rst (version 1.1.1).
///
/// Implemented: device list, import, submit and unlink of control and bulk transfers. Transfers of one endpoint are
/// done one after another, each for the time the device takes. A protocol error ends the session.
/// It serves luxrig-sim's buses, `usbip attach`, and vhci_hcd in a guest.

#include <deque>
#include <functional>
#include <map>

#include "sim/devices/usb/usb_device.h"
#include "sim/faults/faults.h"

namespace luxrig::sim {

class UsbipSession {
 public:
  /// attached: the peer is vhci_hcd, which starts with transfers.
  enum class Beginning { handshake, attached };
  /// `fault`: called once at the start of each transfer; returns its fault:
  ///   silent     it hangs until it is unlinked
  ///   delay      it takes longer
  ///   exception  it stalls
  ///   garbled    a control transfer stalls; an IN transfer has a wrong byte
  using FaultOf = std::function<Disturbance()>;
  /// The device outlives it.
  UsbipSession(UsbDevice& device, Beginning beginning, FaultOf fault = {});

  void receive(Time now, std::span<const std::uint8_t> bytes);
  /// Begins and ends transfers that are due.
  void serve(Time now);
  [[nodiscard]] std::vector<std::uint8_t> take_output();
  /// The peer broke the protocol or asked for more than fits: hang up.
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

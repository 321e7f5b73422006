#pragma once
/// Live capture into a pcap file, by libpcap: only packets of a rig's buses.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/rig/rig.h"

namespace luxrig::recording {

/// What of a rig can be captured.
struct CaptureFilter {
  std::string text;  ///< of packets, as tcpdump and tshark take it; empty: nothing
  /// Buses that no capture sees, and why: "dimmers: a serial line".
  std::vector<std::string> unseen;
};
/// requires a rig whose buses were checked. all_interfaces: the pseudo-device `any`; else CAN is left out, as its
/// interfaces have no Ethernet.
[[nodiscard]] CaptureFilter filter_for(const Rig& rig, bool all_interfaces);

class Capture {
 public:
  /// interface: "any" or a name. A fault says what is missing; Cause::refused: the right to capture.
  [[nodiscard]] static Result<Capture> begin(const std::string& interface, const std::string& filter,
                                             const std::filesystem::path& file);
  Capture(Capture&&) noexcept;
  Capture& operator=(Capture&&) noexcept;
  ~Capture();  ///< closes the file

  struct Counts {
    std::size_t sacn = 0, artnet = 0, modbus = 0, can = 0, other = 0;
    std::size_t dropped = 0;  ///< by the kernel, so far
    friend bool operator==(const Counts&, const Counts&) = default;
  };
  /// Writes the packets that are there; call it often. Counts add up from the beginning.
  Result<void> step();
  [[nodiscard]] const Counts& counts() const;
  /// What was captured is in the file from now on.
  Result<void> flush();

 private:
  struct State;
  explicit Capture(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace luxrig::recording

#pragma once
/// Traffic of a real rig, read from a file: what lighting desks sent, what Modbus devices answered, what was on CAN.
/// A pcap or pcapng file by any program (luxrig record, Wireshark, tcpdump), or a show by OLA's ola_recorder.

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "drivers/dmx/sacn/sacn_codec.h"
#include "drivers/io/datagram.h"
#include "drivers/modbus/modbus_codec.h"

namespace luxrig::recording {

enum class Protocol { sacn, artnet, ola };
[[nodiscard]] std::string_view name_of(Protocol protocol);  ///< "sACN"

/// Somebody who sent DMX. sACN tells sources apart by their CID, Art-Net by their address.
struct Source {
  Protocol protocol = Protocol::sacn;
  std::string name;  ///< sACN: its own; Art-Net: its address
  sacn::Cid cid{};
  SocketAddress address;   ///< of its first packet
  bool sent_here = false;  ///< by the computer that recorded, where the file tells so
  std::set<int> universes;
  std::size_t packets = 0;
};

struct DmxPacket {
  Duration at{};
  std::size_t source = 0;
  std::optional<int> universe;      ///< Art-Net: port address; none: it synchronises
  std::vector<std::uint8_t> bytes;  ///< the datagram; of OLA: the slots
};

/// A Modbus request that was answered as it asks.
struct ModbusExchange {
  Duration at{};  ///< of the answer
  SocketAddress server;
  modbus::Request request;
  std::vector<std::uint16_t> values;  ///< read
};

/// Positions that a CANopen drive reported, in TPDO 1 as Luxrig maps it.
struct DrivePositions {
  std::int32_t least = 0, greatest = 0;
  std::size_t reports = 0;
};

/// Times count from the first packet. Lists are in order of time.
struct Recording {
  Duration length{};
  std::size_t packets = 0;  ///< all in the file, also those that are of nothing here
  std::vector<Source> sources;
  std::vector<DmxPacket> dmx;
  std::vector<ModbusExchange> modbus;
  std::set<std::uint32_t> modbus_clients;  ///< their IPv4 addresses
  std::size_t modbus_refused = 0, modbus_unanswered = 0;
  std::map<std::uint32_t, std::size_t> can_frames;  ///< by identifier
  std::map<int, DrivePositions> drives;             ///< by node
};

inline constexpr std::size_t kMaxBytes = std::size_t{256} << 20;
inline constexpr Duration kLongest = std::chrono::hours(24 * 7);
inline constexpr std::uint16_t kModbusPort = 502;

/// modbus_ports: TCP ports of Modbus servers, beside 502. Problems are of that file: "packet 17: …", or a line.
[[nodiscard]] Checked<Recording> read_recording(const std::filesystem::path& path,
                                                const std::set<std::uint16_t>& modbus_ports);

/// The same for one kind of file. The stream of a pcap file is closed.
[[nodiscard]] Checked<Recording> read_pcap(std::FILE* stream, const std::string& file,
                                           const std::set<std::uint16_t>& modbus_ports);
[[nodiscard]] Checked<Recording> read_ola_show(std::string_view text, const std::string& file);

}  // namespace luxrig::recording

#include "sim/wire/artnet/artnet_rdm_gate.h"

#include <algorithm>

#include "sim/wire/bytes.h"

namespace luxrig::sim {
namespace {

constexpr int kOpTodRequest = 0x8000, kOpTodData = 0x8100, kOpTodControl = 0x8200, kOpRdm = 0x8300;
constexpr std::uint8_t kFlush = 1;
constexpr std::size_t kMaxUids = 200;     // in one ArtTodData
constexpr std::size_t kMaxPorts = 32;     // in one ArtTodRequest
constexpr std::size_t kShortestRdm = 25;  // without its start code: 24 bytes after it, checksum included
constexpr std::uint8_t kArtNet[] = {'A', 'r', 't', '-', 'N', 'e', 't', 0};

int op_code_of(std::span<const std::uint8_t> packet) {
  if (packet.size() < 24 || !std::equal(std::begin(kArtNet), std::end(kArtNet), packet.begin())) return -1;
  return big_endian_16(packet, 10) >= 14 ? little_endian_16(packet, 8) : -1;
}

std::vector<std::uint8_t> head_of(int op_code, int port_address) {
  std::vector<std::uint8_t> packet(24, 0);
  std::copy(std::begin(kArtNet), std::end(kArtNet), packet.begin());
  packet[8] = static_cast<std::uint8_t>(op_code & 0xff);
  packet[9] = static_cast<std::uint8_t>(op_code >> 8);
  packet[11] = 14;  // protocol version
  packet[12] = 1;   // RDM version
  packet[21] = static_cast<std::uint8_t>(port_address >> 8);
  packet[23] = static_cast<std::uint8_t>(port_address & 0xff);
  return packet;
}

}  // namespace

ArtnetRdmGate::ArtnetRdmGate(std::map<int, RdmLine>& lines) {
  int page = -1, on_page = 0, bind_index = 0;
  for (auto& [port_address, line] : lines) {
    if (port_address >> 4 != page || on_page == 4) {
      page = port_address >> 4;
      on_page = 0;
      ++bind_index;
    }
    ports_[port_address] = {&line, line.reachable(), ++on_page, std::min(bind_index, 255)};
  }
}

std::vector<ArtnetRdmGate::Answer> ArtnetRdmGate::receive(Time now, std::span<const std::uint8_t> packet) {
  std::vector<Answer> answers;
  const int op_code = op_code_of(packet);
  if (op_code == kOpTodRequest) {
    const std::size_t count = packet[23];
    if (packet[22] != 0 || count > kMaxPorts || packet.size() < 24 + count) return answers;
    for (std::size_t i = 0; i < count; ++i) {
      const auto port = ports_.find(packet[21] << 8 | packet[24 + i]);
      if (port != ports_.end()) tell_table(port->first, port->second, answers);
    }
    return answers;
  }
  if (op_code != kOpTodControl && op_code != kOpRdm) return answers;
  const auto port = ports_.find(packet[21] << 8 | packet[23]);
  if (port == ports_.end()) return answers;
  if (op_code == kOpTodControl) {
    if (packet[22] != kFlush) return answers;
    port->second.table = port->second.line->reachable();
    tell_table(port->first, port->second, answers);
    return answers;
  }
  if (packet[22] != 0 || packet.size() < 24 + kShortestRdm) return answers;
  std::vector<std::uint8_t> on_line = {0xcc};
  on_line.insert(on_line.end(), packet.begin() + 24, packet.end());
  const RdmLine::Answer answer = port->second.line->exchange(now, on_line);
  // Bytes without a start code answer a discovery request; a node does not pass these on.
  if (answer.bytes.empty() || answer.bytes[0] != 0xcc) return answers;
  std::vector<std::uint8_t> back = head_of(kOpRdm, port->first);
  back.insert(back.end(), answer.bytes.begin() + 1, answer.bytes.end());
  answers.push_back({std::move(back), answer.late});
  return answers;
}

void ArtnetRdmGate::tell_table(int port_address, const Port& port, std::vector<Answer>& answers) const {
  const std::size_t total = port.table.size();
  for (std::size_t begin = 0, block = 0; begin < total || block == 0; begin += kMaxUids, ++block) {
    const std::size_t end = std::min(begin + kMaxUids, total);
    std::vector<std::uint8_t> packet = head_of(kOpTodData, port_address);
    packet[13] = static_cast<std::uint8_t>(port.number);
    packet[20] = static_cast<std::uint8_t>(port.bind_index);
    append_big_endian_16(packet, static_cast<int>(total));
    packet.push_back(static_cast<std::uint8_t>(block));
    packet.push_back(static_cast<std::uint8_t>(end - begin));
    for (std::size_t i = begin; i < end; ++i) {
      for (int shift = 40; shift >= 0; shift -= 8) {
        packet.push_back(static_cast<std::uint8_t>(port.table[i] >> shift & 0xff));
      }
    }
    answers.push_back({std::move(packet), {}});
  }
}

}  // namespace luxrig::sim

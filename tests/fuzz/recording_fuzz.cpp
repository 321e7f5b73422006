// Any bytes as a pcap or pcapng file: refused with a place, or read; and what is read can be sent again.
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "core/text/plain_text.h"
#include "tools/recording/desk_player.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  using namespace luxrig::recording;
  if (size == 0) return 0;
  std::FILE* stream = ::fmemopen(const_cast<std::uint8_t*>(data), size, "rb");
  if (stream == nullptr) std::abort();
  const auto read = read_pcap(stream, "fuzz.pcap", {1502});
  if (!read) {
    for (const Problem& problem : read.error())
      if (problem.what.empty() || problem.mend.empty() || !is_plain_text(problem.text())) std::abort();
    return 0;
  }
  Duration before{};
  for (const DmxPacket& packet : read->dmx) {
    if (packet.at < before || packet.at > read->length || packet.source >= read->sources.size()) std::abort();
    before = packet.at;
  }
  for (const ModbusExchange& exchange : read->modbus)
    if (exchange.at < Duration{} || exchange.at > read->length) std::abort();
  DeskPlayer player(
      *read, {std::vector<bool>(read->sources.size(), true),
              {{Protocol::sacn, std::nullopt, 5568, std::nullopt}, {Protocol::artnet, 0x0A000001, 6454, std::nullopt}},
              1,
              false});
  if (player.due(read->length).size() != player.packets() || player.next()) std::abort();
  (void)player.goodbyes();
  return 0;
}

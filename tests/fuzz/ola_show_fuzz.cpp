// Any text as a show by ola_recorder: refused with its line, or read.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/text/plain_text.h"
#include "tools/recording/recording.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  const auto read = recording::read_ola_show({reinterpret_cast<const char*>(data), size}, "fuzz.ola");
  if (!read) {
    for (const Problem& problem : read.error())
      if (problem.what.empty() || problem.mend.empty() || problem.line < 1 || !is_plain_text(problem.text()))
        std::abort();
    return 0;
  }
  Duration before{};
  for (const recording::DmxPacket& packet : read->dmx) {
    if (packet.at < before || packet.at > read->length || packet.bytes.empty() || packet.bytes.size() > 512)
      std::abort();
    before = packet.at;
  }
  return 0;
}

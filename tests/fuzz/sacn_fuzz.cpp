/// Any packet that the sACN decoder accepts must encode to the very same bytes (except those after the NUL of the name
/// and option bits without meaning), and decode to the same values again.
#include <cstdlib>

#include "drivers/dmx/sacn/sacn_codec.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig::sacn;
  const auto packet = decode({data, size});
  if (!packet) return 0;
  const auto bytes = encode(*packet);
  if (bytes.size() != size) std::abort();
  const auto again = decode(bytes);
  if (!again || encode(*again) != bytes || again->slots != packet->slots || again->universe != packet->universe ||
      again->sequence != packet->sequence || again->cid != packet->cid) {
    std::abort();
  }
  return 0;
}

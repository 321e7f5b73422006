// Any text as a --redirect of the guardian: nothing, or a bus and its target, which are written and read the same.
#include <cstdint>
#include <string>

#include "core/check.h"
#include "tools/luxrigd/guardian/guardian_words.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto redirect = luxrig::redirect_of(text);
  if (!redirect) return 0;
  const auto& [bus, to] = *redirect;
  if (to.path.empty())
    LUXRIG_CHECK(to.port >= 1 && to.port <= 65535, "port {}", to.port);
  else
    LUXRIG_CHECK(to.path.front() == '/' && to.host.empty() && to.port == 0, "path {} and host {}", to.path, to.host);
  LUXRIG_CHECK(text.starts_with(bus + "="), "bus {} of {}", bus, text);
  const auto again = luxrig::redirect_of(luxrig::redirect_text(bus, to));
  LUXRIG_CHECK(again.has_value(), "own text refused: {}", luxrig::redirect_text(bus, to));
  LUXRIG_CHECK(again->first == bus && again->second.host == to.host && again->second.port == to.port &&
                   again->second.path == to.path,
               "not the same when written again: {}", text);
  return 0;
}

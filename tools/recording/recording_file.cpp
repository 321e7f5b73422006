#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "tools/recording/recording.h"

namespace luxrig::recording {
namespace {

constexpr std::string_view kOlaBegins = "OLA Show";

}  // namespace

std::string_view name_of(Protocol protocol) {
  constexpr std::string_view kNames[] = {"sACN", "Art-Net", "OLA"};
  return kNames[static_cast<std::size_t>(protocol)];
}

Checked<Recording> read_recording(const std::filesystem::path& path, const std::set<std::uint16_t>& modbus_ports) {
  const auto problem = [&](std::string what, std::string mend) {
    return tl::unexpected(std::vector<Problem>{{path.string(), 0, 0, std::move(what), std::move(mend)}});
  };
  std::error_code error;
  // Reading a device or a pipe may never end.
  if (!std::filesystem::is_regular_file(path, error))
    return problem(error ? error.message() : "this is no file", "name a recording: luxrig record makes one");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return problem(error.message(), "name a recording that can be read");
  if (size > kMaxBytes)
    return problem(fmt::format("the file has {} MiB", size >> 20),
                   fmt::format("cut it to {} MiB: editcap -A … -B …", kMaxBytes >> 20));
  std::FILE* stream = std::fopen(path.c_str(), "rbe");
  if (stream == nullptr) return problem(std::strerror(errno), "name a recording that can be read");
  char begin[kOlaBegins.size()];
  const std::size_t got = std::fread(begin, 1, sizeof(begin), stream);
  if (std::string_view(begin, got) != kOlaBegins) {
    std::rewind(stream);
    return read_pcap(stream, path.string(), modbus_ports);
  }
  std::string text(begin, got);
  text.resize(static_cast<std::size_t>(size));
  text.resize(got + std::fread(text.data() + got, 1, text.size() - got, stream));
  std::fclose(stream);
  return read_ola_show(text, path.string());
}

}  // namespace luxrig::recording

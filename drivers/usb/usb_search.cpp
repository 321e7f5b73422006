#include "drivers/usb/usb_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace luxrig {
namespace {

bool is_kind(const UsbKind& kind, const UsbCandidate& candidate) {
  return kind.vendor == candidate.vendor && kind.product == candidate.product;
}

bool has_names(const UsbKind& kind) { return !kind.manufacturer.empty() || !kind.product_name.empty(); }

bool digits_only(std::string_view text) {
  return !text.empty() && text.size() <= 3 &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

std::string wanted(const UsbSearch& search) {
  std::string text = search.what;
  if (!search.serial.empty()) text += fmt::format(" with serial number {}", search.serial);
  if (!search.port.empty()) text += fmt::format(" at USB port {}", search.port);
  return text;
}

}  // namespace

bool may_match(const UsbSearch& search, const UsbCandidate& candidate) {
  if (!search.port.empty() && search.port != candidate.port) return false;
  return std::any_of(search.kinds.begin(), search.kinds.end(),
                     [&](const UsbKind& kind) { return is_kind(kind, candidate); });
}

bool needs_strings(const UsbSearch& search, const UsbCandidate& candidate) {
  if (!search.serial.empty()) return true;
  return std::none_of(search.kinds.begin(), search.kinds.end(),
                      [&](const UsbKind& kind) { return is_kind(kind, candidate) && !has_names(kind); });
}

bool matches(const UsbSearch& search, const UsbCandidate& candidate) {
  if (!may_match(search, candidate)) return false;
  if (!search.serial.empty() && search.serial != candidate.serial) return false;
  return std::any_of(search.kinds.begin(), search.kinds.end(), [&](const UsbKind& kind) {
    return is_kind(kind, candidate) && (kind.manufacturer.empty() || kind.manufacturer == candidate.manufacturer) &&
           (kind.product_name.empty() || kind.product_name == candidate.product_name);
  });
}

Result<std::size_t> choose(const UsbSearch& search, std::span<const UsbCandidate> matching) {
  if (matching.size() == 1) return 0;
  if (matching.empty()) {
    return tl::unexpected(Fault{
        Cause::network, {}, fmt::format("no {} is plugged in: check the cable, `lsusb` lists it", wanted(search)), {}});
  }
  std::string list;
  for (const UsbCandidate& candidate : matching) list += (list.empty() ? "" : ", ") + text_of(candidate);
  return tl::unexpected(Fault{Cause::invalid,
                              {},
                              fmt::format("{} devices may be the {} ({}): give the bus serial or usb_port",
                                          matching.size(), wanted(search), list),
                              {}});
}

std::string port_path(int bus, std::span<const std::uint8_t> ports) {
  std::string path = fmt::format("{}-", bus);
  for (std::size_t i = 0; i < ports.size(); ++i) path += fmt::format("{}{}", i == 0 ? "" : ".", ports[i]);
  return path;
}

bool is_port_path(std::string_view text) {
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos || !digits_only(text.substr(0, dash))) return false;
  for (std::size_t from = dash + 1;;) {
    const std::size_t dot = std::min(text.find('.', from), text.size());
    if (!digits_only(text.substr(from, dot - from))) return false;
    if (dot == text.size()) return true;
    from = dot + 1;
  }
}

std::string text_of(const UsbCandidate& candidate) {
  return fmt::format("{:04x}:{:04x}{}{} at {}", candidate.vendor, candidate.product,
                     candidate.serial.empty() ? "" : " ", candidate.serial, candidate.port);
}

}  // namespace luxrig

#include "sim/devices/usb/usb_device.h"

#include <algorithm>

namespace luxrig::sim {
namespace {

constexpr std::uint8_t kIn = 0x80, kTypeBits = 0x60, kVendorType = 0x40;
constexpr std::uint8_t kGetStatus = 0, kGetDescriptor = 6, kGetConfiguration = 8;
constexpr int kDeviceDescriptor = 1, kConfigurationDescriptor = 2, kStringDescriptor = 3;

std::vector<std::uint8_t> string_descriptor(const UsbDescriptors& all, std::size_t index) {
  if (index == 0) return {4, kStringDescriptor, 0x09, 0x04};  // the languages: only English
  if (index > all.strings.size()) return {};
  const std::string& text = all.strings[index - 1];
  std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(2 + 2 * text.size()), kStringDescriptor};
  for (const char letter : text) {
    bytes.push_back(static_cast<std::uint8_t>(letter));
    bytes.push_back(0);
  }
  return bytes;
}

}  // namespace

UsbControl usb_control(std::span<const std::uint8_t, 8> setup) {
  const auto word = [&](std::size_t at) { return static_cast<std::uint16_t>(setup[at] | setup[at + 1] << 8); };
  return {setup[0], setup[1], word(2), word(4), word(6)};
}

UsbReply UsbDevice::control(Time now, const UsbControl& setup, std::span<const std::uint8_t> out) {
  if ((setup.request_type & kTypeBits) == kVendorType) return vendor(now, setup, out);
  UsbReply reply;
  if ((setup.request_type & kTypeBits) != 0) return {UsbReply::Kind::stall, {}, 0, {}};
  if ((setup.request_type & kIn) == 0) return reply;  // set configuration, set interface, clear feature
  if (setup.request == kGetDescriptor) {
    const UsbDescriptors& all = descriptors();
    const int kind = setup.value >> 8;
    if (kind == kDeviceDescriptor) reply.data = all.device;
    if (kind == kConfigurationDescriptor) reply.data = all.configuration;
    if (kind == kStringDescriptor) reply.data = string_descriptor(all, setup.value & 0xff);
  } else if (setup.request == kGetStatus) {
    reply.data = {0, 0};
  } else if (setup.request == kGetConfiguration) {
    reply.data = {1};
  }
  if (reply.data.empty()) return {UsbReply::Kind::stall, {}, 0, {}};
  reply.data.resize(std::min<std::size_t>(reply.data.size(), setup.length));
  return reply;
}

std::vector<std::uint8_t> usb_device_descriptor(std::uint16_t vendor, std::uint16_t product, bool low_speed,
                                                bool has_serial) {
  const auto low = [](std::uint16_t word) { return static_cast<std::uint8_t>(word); };
  const auto high = [](std::uint16_t word) { return static_cast<std::uint8_t>(word >> 8); };
  return {18,
          kDeviceDescriptor,
          0x10,
          0x01,
          0xff,
          0,
          0,
          static_cast<std::uint8_t>(low_speed ? 8 : 64),
          low(vendor),
          high(vendor),
          low(product),
          high(product),
          0x00,
          0x06,
          1,
          2,
          static_cast<std::uint8_t>(has_serial ? 3 : 0),
          1};
}

std::vector<std::uint8_t> usb_configuration_descriptor(std::span<const UsbEndpointSize> endpoints) {
  const std::size_t total = 9 + 9 + 7 * endpoints.size();
  std::vector<std::uint8_t> bytes{9, kConfigurationDescriptor, static_cast<std::uint8_t>(total), 0, 1, 1, 0, 0x80, 50};
  bytes.insert(bytes.end(), {9, 4, 0, 0, static_cast<std::uint8_t>(endpoints.size()), 0xff, 0xff, 0xff, 0});
  for (const UsbEndpointSize& endpoint : endpoints) {
    bytes.insert(bytes.end(), {7, 5, endpoint.address, 2, static_cast<std::uint8_t>(endpoint.packet_bytes),
                               static_cast<std::uint8_t>(endpoint.packet_bytes >> 8), 0});
  }
  return bytes;
}

}  // namespace luxrig::sim

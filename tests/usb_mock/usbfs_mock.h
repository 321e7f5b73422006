#pragma once
/// A simulated widget below the real libusb. umockdev replaces sysfs, udev and the ioctls of usbfs, and passes the
/// transfers to a model from sim/devices/usb/. Runs under umockdev-wrapper. The model's clock is the real one.

#include <cerrno>
#include <chrono>
#include <cstring>
#include <list>
#include <map>
#include <mutex>
#include <string>

// Before usbdevice_fs.h, which uses macros from it.
#include <sys/ioctl.h>
// clang-format off
#include <linux/usbdevice_fs.h>
// clang-format on
#include <umockdev.h>

#include "sim/devices/usb/usb_device.h"

namespace luxrig {

class UsbfsMock {
 public:
  explicit UsbfsMock(sim::UsbDevice& device) : device_(device), testbed_(umockdev_testbed_new()) {
    handler_ = umockdev_ioctl_base_new();
    g_signal_connect_after(handler_, "handle-ioctl", G_CALLBACK(on_ioctl), this);
    umockdev_testbed_attach_ioctl(testbed_, kNode, handler_, nullptr);
  }
  ~UsbfsMock() {
    unplug();
    umockdev_testbed_detach_ioctl(testbed_, kNode, nullptr);
    g_object_unref(handler_);
    g_object_unref(testbed_);
  }
  UsbfsMock(const UsbfsMock&) = delete;
  UsbfsMock& operator=(const UsbfsMock&) = delete;

  void plug() {
    {
      const std::lock_guard guard(mutex_);
      device_.power_on(now());
      gone_ = false;
    }
    std::string hex;
    const sim::UsbDescriptors& all = device_.descriptors();
    for (const auto* part : {&all.device, &all.configuration}) {
      for (const std::uint8_t byte : *part) {
        constexpr char kDigits[] = "0123456789ABCDEF";
        hex += kDigits[byte >> 4];
        hex += kDigits[byte & 15];
      }
    }
    const std::string text =
        std::string("P: /devices/usb1/1-1\nN: bus/usb/001/002\nE: SUBSYSTEM=usb\nE: BUSNUM=001\n") +
        "E: DEVNUM=002\nE: DEVNAME=/dev/bus/usb/001/002\nE: DEVTYPE=usb_device\n" +
        "A: bConfigurationValue=1\\n\nA: busnum=1\\n\nA: devnum=2\\n\nA: speed=" + (all.low_speed ? "1.5" : "12") +
        "\\n\nH: descriptors=" + hex + "\n";
    umockdev_testbed_add_from_string(testbed_, text.c_str(), nullptr);
    plugged_in_ = true;
  }
  void unplug() {
    if (!plugged_in_) return;
    {
      const std::lock_guard guard(mutex_);
      gone_ = true;
      claimed_ = false;
    }
    umockdev_testbed_uevent(testbed_, kSysfs, "remove");
    umockdev_testbed_remove_device(testbed_, kSysfs);
    plugged_in_ = false;
  }

  // Faults and observations. Guarded by the mutex, as ioctls come in another thread.
  struct State {
    int stalls = 0, hangs = 0;   ///< number of next outgoing vendor requests or bulk transfers
    bool kernel_driver = false;  ///< ftdi_sio holds the interface
    bool other_program = false;  ///< another program holds it through usbfs
    int detached = 0, attached = 0, claims = 0, releases = 0, discarded = 0;
    std::vector<sim::UsbControl> requests;  ///< outgoing vendor requests
  };
  template <class Call>
  auto with(Call call) {
    const std::lock_guard guard(mutex_);
    return call(state_);
  }
  [[nodiscard]] std::optional<sim::UsbDmxLook> line() {
    const std::lock_guard guard(mutex_);
    return device_.line(now());
  }

 private:
  static constexpr const char* kNode = "/dev/bus/usb/001/002";
  static constexpr const char* kSysfs = "/sys/devices/usb1/1-1";

  struct Urb {
    UMockdevIoctlData* data = nullptr;    ///< usbdevfs_urb
    UMockdevIoctlData* buffer = nullptr;  ///< its target
    bool begun = false, hangs = false;
    Time due{};
    int status = 0;
    std::vector<std::uint8_t> in;
    std::size_t actual = 0;
  };

  static Time now() {
    return Time{} + std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch());
  }

  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
    return static_cast<UsbfsMock*>(self)->handle(client);
  }

  gboolean handle(UMockdevIoctlClient* client) {
    const std::lock_guard guard(mutex_);
    UMockdevIoctlData* arg = umockdev_ioctl_client_get_arg(client);
    const auto answer = [&](int result, int error = 0) {
      umockdev_ioctl_client_complete(client, result, error);
      return TRUE;
    };
    const unsigned long request = umockdev_ioctl_client_get_request(client);
    // An unplugged device still returns its transfers.
    if (gone_ && request != USBDEVFS_REAPURB && request != USBDEVFS_REAPURBNDELAY) return answer(-1, ENODEV);
    switch (request) {
      case USBDEVFS_GET_CAPABILITIES: {
        const std::uint32_t capabilities =
            USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_BULK_CONTINUATION | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
        put(arg, capabilities);
        return answer(0);
      }
      case USBDEVFS_CLAIMINTERFACE:
        if (state_.kernel_driver || state_.other_program) return answer(-1, EBUSY);
        claimed_ = true;
        ++state_.claims;
        return answer(0);
      case USBDEVFS_RELEASEINTERFACE:
        claimed_ = false;
        ++state_.releases;
        return answer(0);
      case USBDEVFS_GETDRIVER: {
        if (!state_.kernel_driver && !state_.other_program) return answer(-1, ENODATA);
        usbdevfs_getdriver driver{};
        std::strcpy(driver.driver, state_.kernel_driver ? "ftdi_sio" : "usbfs");
        put(arg, driver);
        return answer(0);
      }
      case USBDEVFS_IOCTL: {
        auto* data = umockdev_ioctl_data_resolve(arg, 0, sizeof(usbdevfs_ioctl), nullptr);
        const int code = reinterpret_cast<const usbdevfs_ioctl*>(data->data)->ioctl_code;
        umockdev_ioctl_data_unref(data);
        if (code == static_cast<int>(USBDEVFS_DISCONNECT)) {
          if (!state_.kernel_driver) return answer(-1, ENODATA);
          state_.kernel_driver = false;
          ++state_.detached;
          return answer(0);
        }
        if (code == static_cast<int>(USBDEVFS_CONNECT)) {
          if (claimed_) return answer(-1, EBUSY);
          state_.kernel_driver = true;
          ++state_.attached;
          return answer(1);
        }
        return answer(-1, ENOTTY);
      }
      case USBDEVFS_CLEAR_HALT:
      case USBDEVFS_RESET:
      case USBDEVFS_SETCONFIGURATION:
        return answer(0);
      case USBDEVFS_SUBMITURB:
        submit(arg);
        return answer(0);
      case USBDEVFS_REAPURB:
      case USBDEVFS_REAPURBNDELAY:
        run();
        if (finished_.empty()) return answer(-1, gone_ ? ENODEV : EAGAIN);
        hand_back(arg);
        return answer(0);
      case USBDEVFS_DISCARDURB:
        return discard(*reinterpret_cast<gulong*>(arg->data)) ? answer(0) : answer(-1, EINVAL);
      default:
        return FALSE;
    }
  }

  template <class T>
  static void put(UMockdevIoctlData* arg, T value) {
    auto* data = umockdev_ioctl_data_resolve(arg, 0, sizeof(T), nullptr);
    umockdev_ioctl_data_update(data, 0, reinterpret_cast<guint8*>(&value), sizeof(T));
    umockdev_ioctl_data_unref(data);
  }

  void submit(UMockdevIoctlData* arg) {
    Urb urb;
    urb.data = umockdev_ioctl_data_resolve(arg, 0, sizeof(usbdevfs_urb), nullptr);
    const auto* raw = reinterpret_cast<const usbdevfs_urb*>(urb.data->data);
    if (raw->buffer_length > 0) {
      urb.buffer = umockdev_ioctl_data_resolve(urb.data, offsetof(usbdevfs_urb, buffer),
                                               static_cast<gsize>(raw->buffer_length), nullptr);
    }
    const int key = raw->type == USBDEVFS_URB_TYPE_CONTROL ? 0 : raw->endpoint;
    queues_[key].push_back(std::move(urb));
    run();
  }

  void run() {
    for (auto& [endpoint, queue] : queues_) {
      while (!queue.empty()) {
        Urb& urb = queue.front();
        if (gone_) {
          urb.status = -ENODEV;
        } else {
          if (!urb.begun && !urb.hangs) begin(endpoint, urb);
          if (!urb.begun || urb.due > now()) break;
        }
        finished_.splice(finished_.end(), queue, queue.begin());
      }
    }
  }

  void begin(int endpoint, Urb& urb) {
    const auto* raw = reinterpret_cast<const usbdevfs_urb*>(urb.data->data);
    const std::span<const std::uint8_t> bytes(urb.buffer != nullptr ? urb.buffer->data : nullptr,
                                              static_cast<std::size_t>(std::max(raw->buffer_length, 0)));
    sim::UsbReply reply;
    const bool control = raw->type == USBDEVFS_URB_TYPE_CONTROL;
    sim::UsbControl setup;
    if (control) setup = sim::usb_control(bytes.first<8>());
    const bool out = control ? setup.request_type == 0x40 : (endpoint & 0x80) == 0;
    if (out && state_.hangs > 0) {
      --state_.hangs;
      urb.hangs = true;
      return;
    }
    if (out && state_.stalls > 0) {
      --state_.stalls;
      reply.kind = sim::UsbReply::Kind::stall;
    } else if (control) {
      if (out) state_.requests.push_back(setup);
      reply = device_.control(now(), setup, bytes.subspan(8));
    } else if (out) {
      reply = device_.bulk_out(now(), endpoint, bytes);
    } else {
      reply = device_.bulk_in(now(), endpoint, bytes.size());
      if (reply.kind == sim::UsbReply::Kind::wait) return;
    }
    urb.begun = true;
    urb.due = now() + reply.takes;
    urb.status = reply.kind == sim::UsbReply::Kind::done ? 0 : -EPIPE;
    urb.actual = reply.data.empty() ? reply.taken : reply.data.size();
    urb.in = std::move(reply.data);
  }

  void hand_back(UMockdevIoctlData* arg) {
    Urb urb = std::move(finished_.front());
    finished_.pop_front();
    usbdevfs_urb raw = *reinterpret_cast<const usbdevfs_urb*>(urb.data->data);
    raw.status = urb.status;
    raw.actual_length = static_cast<int>(urb.actual);
    umockdev_ioctl_data_update(urb.data, offsetof(usbdevfs_urb, status), reinterpret_cast<guint8*>(&raw.status),
                               sizeof raw.status);
    umockdev_ioctl_data_update(urb.data, offsetof(usbdevfs_urb, actual_length),
                               reinterpret_cast<guint8*>(&raw.actual_length), sizeof raw.actual_length);
    if (!urb.in.empty() && urb.buffer != nullptr) {
      const gsize at = raw.type == USBDEVFS_URB_TYPE_CONTROL ? 8 : 0;
      umockdev_ioctl_data_update(urb.buffer, at, urb.in.data(), static_cast<gint>(urb.in.size()));
    }
    auto* pointer = umockdev_ioctl_data_resolve(arg, 0, sizeof(void*), nullptr);
    umockdev_ioctl_data_set_ptr(pointer, 0, urb.data);
    umockdev_ioctl_data_unref(pointer);
    if (urb.buffer != nullptr) umockdev_ioctl_data_unref(urb.buffer);
    umockdev_ioctl_data_unref(urb.data);
  }

  bool discard(gulong address) {
    for (auto& [endpoint, queue] : queues_) {
      for (auto urb = queue.begin(); urb != queue.end(); ++urb) {
        if (urb->data->client_addr != address) continue;
        urb->status = -ENOENT;
        urb->in.clear();
        urb->actual = 0;
        ++state_.discarded;
        finished_.splice(finished_.end(), queue, urb);
        return true;
      }
    }
    return false;
  }

  sim::UsbDevice& device_;
  UMockdevTestbed* testbed_;
  UMockdevIoctlBase* handler_ = nullptr;
  std::mutex mutex_;
  State state_;
  bool plugged_in_ = false, gone_ = true, claimed_ = false;
  std::map<int, std::list<Urb>> queues_;
  std::list<Urb> finished_;
};

}  // namespace luxrig

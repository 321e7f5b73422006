#pragma once
/// The status for clients that have an earlier one: only what has changed since. A point costs bytes only when it
/// changes.

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "tools/luxrigd/api/status_json.h"

namespace luxrig {

class StatusChanges {
 public:
  StatusChanges();

  /// JSON: StatusChanges in openapi.json. `version` is that of an answer before; with one that is too old, of another
  /// daemon or of another rig, or with none, the answer is whole. rig: owns input.rig. rig_etag: of GET /api/rig; empty
  /// until that is there. Any thread.
  [[nodiscard]] std::string since(std::string_view version, const StatusInput& input, std::shared_ptr<const void> rig,
                                  std::string_view rig_etag);

 private:
  struct Item {
    std::string json;
    std::uint64_t changed = 0;  ///< number of the version that brought it
  };
  void take(const StatusInput& input);
  void put(Item& item, std::string text);
  [[nodiscard]] std::string prefix() const;

  const std::uint64_t daemon_;  ///< of this process alone
  std::mutex mutex_;            // guards all below
  std::shared_ptr<const void> rig_;
  std::uint64_t rigs_ = 0;    ///< how many there were
  std::uint64_t number_ = 0;  ///< of the newest version
  bool changing_ = false;     ///< number_ is new since take() began
  std::map<std::string, Item> rest_;
  std::map<std::string, std::vector<Item>> lists_;  ///< fixtures, points, luxmeters, devices
  Time taken_{};
};

}  // namespace luxrig

#pragma once
/// HTTP on loopback: the page, the status, and the few things a client may ask, for those who may. Routes: API.md
/// beside this file.

#include <filesystem>
#include <memory>
#include <string>

#include "core/result.h"
#include "tools/luxrigd/api/command_routes.h"

namespace luxrig {

class HttpApi {
 public:
  HttpApi(HttpHandlers handlers, std::filesystem::path web_folder);
  ~HttpApi();

  /// Binds 127.0.0.1:port (0 = any) and this user's socket for it, leaves the token beside that, and serves on threads
  /// of its own. Returns the port.
  [[nodiscard]] Result<int> start(int port);
  /// Why commands of this user will not find it, a full disk, say; empty: they will. The page is served all the same.
  [[nodiscard]] const std::string& unreachable() const;
  /// Opens one browser, once, within ten minutes.
  [[nodiscard]] std::string one_time_address();
  void stop();

 private:
  Result<void> meet(int port);
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig

#pragma once
/// HTTP: the page, the status and the commands, for clients with access. Routes: API.md beside this folder.

#include <filesystem>
#include <memory>
#include <string>

#include "core/result.h"
#include "core/rig/brief.h"
#include "tools/luxrigd/api/command_routes.h"

namespace luxrig {

class HttpApi {
 public:
  HttpApi(HttpHandlers handlers, std::filesystem::path web_folder);
  ~HttpApi();

  /// Binds the port (0 = any) and this user's socket for it, writes the token beside the socket, and serves on its own
  /// threads. Returns the port. Accounts that cannot be read keep nobody from the rest: problem(). A certificate that
  /// cannot be read is a fault.
  [[nodiscard]] Result<int> start(const DaemonSpec& where);
  /// Why the accounts cannot be read, so that nobody can log in, or the newest certificate; empty if all is well.
  [[nodiscard]] std::string problem() const;
  /// Why commands of this user will not find it, such as a full disk; empty if they will. The page is served all the
  /// same.
  [[nodiscard]] const std::string& unreachable() const;
  /// Address that opens one browser, once, within ten minutes.
  [[nodiscard]] std::string one_time_address();
  void stop();

 private:
  Result<void> meet(int port);
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig

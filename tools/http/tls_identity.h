#pragma once
/// A server's certificate and key, by which it speaks TLS 1.2 and 1.3.

#include <memory>
#include <string>
#include <vector>

#include "core/result.h"

namespace boost::asio::ssl {
class context;
}

namespace luxrig {

class TlsIdentity {
 public:
  /// PEM: the certificate first, then those that lead to its issuer; the key without a password. Refused if they do not
  /// belong together, or if the certificate names no host (subjectAltName): no browser would take it. The files' names
  /// are for the words.
  [[nodiscard]] static Checked<std::shared_ptr<const TlsIdentity>> make(const std::string& certificate_pem,
                                                                        const std::string& key_pem,
                                                                        const std::string& certificate_file,
                                                                        const std::string& key_file);
  ~TlsIdentity();
  TlsIdentity(const TlsIdentity&) = delete;
  TlsIdentity& operator=(const TlsIdentity&) = delete;

  /// The hosts that it is for, in small letters: names, which may begin with "*.", and addresses.
  [[nodiscard]] const std::vector<std::string>& hosts() const { return hosts_; }
  /// OpenSSL counts its references; each connection uses it to its end.
  [[nodiscard]] boost::asio::ssl::context& context() const { return *context_; }

 private:
  TlsIdentity();
  std::unique_ptr<boost::asio::ssl::context> context_;
  std::vector<std::string> hosts_;
};

}  // namespace luxrig

#pragma once
/// A certificate for tests, made anew each time, and a client that speaks TLS.

#include <gtest/gtest.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <string>

#include "tests/tools/http/wire.h"

namespace luxrig::test {

struct MadeCertificate {
  std::string certificate, key;  ///< PEM
};

/// hosts: as OpenSSL writes them, "DNS:rig.example,IP:127.0.0.1"; empty: none.
inline MadeCertificate made_certificate(const char* hosts) {
  EVP_PKEY* const key = EVP_EC_gen("P-256");
  X509* const certificate = X509_new();
  X509_set_version(certificate, 2);
  ASN1_INTEGER_set(X509_get_serialNumber(certificate), 1);
  X509_gmtime_adj(X509_getm_notBefore(certificate), -3600);
  X509_gmtime_adj(X509_getm_notAfter(certificate), 86400);
  X509_set_pubkey(certificate, key);
  X509_NAME_add_entry_by_txt(X509_get_subject_name(certificate), "CN", MBSTRING_ASC,
                             reinterpret_cast<const unsigned char*>("test"), -1, -1, 0);
  X509_set_issuer_name(certificate, X509_get_subject_name(certificate));
  if (*hosts != '\0') {
    X509_EXTENSION* const names = X509V3_EXT_conf_nid(nullptr, nullptr, NID_subject_alt_name, hosts);
    X509_add_ext(certificate, names, -1);
    X509_EXTENSION_free(names);
  }
  X509_sign(certificate, key, EVP_sha256());
  MadeCertificate made;
  const auto text_of = [](auto write) {
    BIO* const to = BIO_new(BIO_s_mem());
    write(to);
    char* data = nullptr;
    const long size = BIO_get_mem_data(to, &data);
    std::string text(data, static_cast<std::size_t>(size));
    BIO_free(to);
    return text;
  };
  made.certificate = text_of([&](BIO* to) { PEM_write_bio_X509(to, certificate); });
  made.key = text_of([&](BIO* to) { PEM_write_bio_PrivateKey(to, key, nullptr, nullptr, 0, nullptr, nullptr); });
  X509_free(certificate);
  EVP_PKEY_free(key);
  return made;
}

/// Connects to loopback by TLS; trusts nobody but does not ask who it is.
class TlsWire {
 public:
  explicit TlsWire(int port, int newest = TLS1_3_VERSION) : wire_(port), context_(SSL_CTX_new(TLS_client_method())) {
    SSL_CTX_set_security_level(context_, 0);  // the server is to refuse what is old, not the client
    SSL_CTX_set_min_proto_version(context_, TLS1_VERSION);
    SSL_CTX_set_max_proto_version(context_, newest);
    SSL_CTX_set_cipher_list(context_, "ALL:@SECLEVEL=0");
    ssl_ = SSL_new(context_);
    SSL_set_fd(ssl_, wire_.descriptor());
    connected_ = SSL_connect(ssl_) == 1;
  }
  ~TlsWire() {
    SSL_free(ssl_);
    SSL_CTX_free(context_);
  }
  TlsWire(const TlsWire&) = delete;
  TlsWire& operator=(const TlsWire&) = delete;

  [[nodiscard]] bool connected() const { return connected_; }
  [[nodiscard]] std::string version() const { return SSL_get_version(ssl_); }
  [[nodiscard]] std::string fingerprint() const {
    X509* const peer = SSL_get1_peer_certificate(ssl_);
    unsigned char bytes[EVP_MAX_MD_SIZE];
    unsigned size = 0;
    if (peer) X509_digest(peer, EVP_sha256(), bytes, &size);
    X509_free(peer);
    return {reinterpret_cast<const char*>(bytes), size};
  }
  /// The answer, until the server ends the connection; `ended_in_order`: with its goodbye.
  std::string ask(const std::string& request) {
    std::string answer;
    for (std::size_t at = 0; at < request.size();) {
      const int n = SSL_write(ssl_, request.data() + at, static_cast<int>(request.size() - at));
      if (n <= 0) break;
      at += static_cast<std::size_t>(n);
    }
    char buffer[4096];
    int n = 0;
    while ((n = SSL_read(ssl_, buffer, sizeof buffer)) > 0) answer.append(buffer, static_cast<std::size_t>(n));
    ended_in_order = SSL_get_error(ssl_, n) == SSL_ERROR_ZERO_RETURN;
    return answer;
  }
  bool ended_in_order = false;

 private:
  Wire wire_;
  SSL_CTX* context_;
  SSL* ssl_ = nullptr;
  bool connected_ = false;
};

}  // namespace luxrig::test

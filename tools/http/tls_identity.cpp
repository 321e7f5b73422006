#include "tools/http/tls_identity.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ssl/context.hpp>
#include <cctype>

namespace luxrig {
namespace {

namespace asio = boost::asio;
namespace ssl = asio::ssl;
using boost::system::error_code;

std::string address_text(const ASN1_OCTET_STRING& bytes) {
  const unsigned char* const data = ASN1_STRING_get0_data(&bytes);
  if (ASN1_STRING_length(&bytes) == 4) {
    asio::ip::address_v4::bytes_type four;
    std::copy_n(data, four.size(), four.begin());
    return asio::ip::make_address_v4(four).to_string();
  }
  if (ASN1_STRING_length(&bytes) == 16) {
    asio::ip::address_v6::bytes_type sixteen;
    std::copy_n(data, sixteen.size(), sixteen.begin());
    return asio::ip::make_address_v6(sixteen).to_string();
  }
  return "";
}

std::vector<std::string> hosts_of(X509* certificate) {
  std::vector<std::string> hosts;
  auto* const names =
      static_cast<GENERAL_NAMES*>(X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr));
  for (int i = 0; names != nullptr && i < sk_GENERAL_NAME_num(names); ++i) {
    const GENERAL_NAME* const name = sk_GENERAL_NAME_value(names, i);
    std::string host;
    if (name->type == GEN_DNS) {
      host.assign(reinterpret_cast<const char*>(ASN1_STRING_get0_data(name->d.dNSName)),
                  static_cast<std::size_t>(ASN1_STRING_length(name->d.dNSName)));
      std::transform(host.begin(), host.end(), host.begin(), [](unsigned char c) { return std::tolower(c); });
    } else if (name->type == GEN_IPADD) {
      host = address_text(*name->d.iPAddress);
    }
    if (!host.empty()) hosts.push_back(std::move(host));
  }
  GENERAL_NAMES_free(names);
  return hosts;
}

}  // namespace

TlsIdentity::TlsIdentity() : context_(std::make_unique<ssl::context>(ssl::context::tls_server)) {}
TlsIdentity::~TlsIdentity() = default;

Checked<std::shared_ptr<const TlsIdentity>> TlsIdentity::make(const std::string& certificate_pem,
                                                              const std::string& key_pem,
                                                              const std::string& certificate_file,
                                                              const std::string& key_file) {
  const auto refused = [](const std::string& file, std::string what, std::string mend) {
    ::ERR_clear_error();
    return tl::unexpected(std::vector<Problem>{{file, 0, 0, std::move(what), std::move(mend)}});
  };
  const std::shared_ptr<TlsIdentity> made(new TlsIdentity);
  ssl::context& context = *made->context_;
  SSL_CTX* const raw = context.native_handle();
  error_code error;
  SSL_CTX_set_min_proto_version(raw, TLS1_2_VERSION);
  SSL_CTX_set_options(raw, SSL_OP_NO_COMPRESSION | SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  // Of TLS 1.2 only those with forward secrecy and authenticated encryption; those of 1.3 are all so.
  SSL_CTX_set_cipher_list(raw, "ECDHE+AESGCM:ECDHE+CHACHA20");
  // Else OpenSSL would ask at the terminal.
  context.set_password_callback([](std::size_t, ssl::context::password_purpose) { return std::string(); }, error);
  context.use_certificate_chain(asio::buffer(certificate_pem), error);
  if (error) return refused(certificate_file, "is no certificate in PEM form", "name the file with the whole chain");
  made->hosts_ = hosts_of(SSL_CTX_get0_certificate(raw));
  if (made->hosts_.empty())
    return refused(certificate_file, "names no host (subjectAltName)", "have one made for the names of this computer");
  context.use_private_key(asio::buffer(key_pem), ssl::context::pem, error);
  if (error || SSL_CTX_check_private_key(raw) != 1)
    return refused(key_file, "is no key in PEM form without a password, or of another certificate",
                   "name the key that was made with the certificate");
  return std::shared_ptr<const TlsIdentity>(made);
}

}  // namespace luxrig

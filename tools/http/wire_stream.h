#pragma once
/// The bytes of one connection: as they are on the socket, or within TLS. All functions and their `done` run on the
/// thread of the socket's io_context. Only the files that need the wire include it: it takes long to compile.

#include <openssl/err.h>
#include <openssl/ssl.h>

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/write.hpp>
#include <memory>
#include <optional>

#include "tools/http/tls_identity.h"

namespace luxrig {

class WireStream {
 public:
  using Socket = boost::asio::generic::stream_protocol::socket;
  using Error = boost::system::error_code;

  /// tls: null for plain.
  WireStream(Socket socket, std::shared_ptr<const TlsIdentity> tls) : socket_(std::move(socket)), tls_(std::move(tls)) {
    if (tls_) secure_.emplace(socket_, tls_->context());
  }

  [[nodiscard]] bool secure() const { return secure_.has_value(); }

  /// done(Error): bytes of requests can be read.
  template <class Done>
  void begin(Done done) {
    if (secure_)
      secure_->async_handshake(boost::asio::ssl::stream_base::server, std::move(done));
    else
      done(Error());
  }
  /// After a failed begin(): the peer has begun to speak HTTP. It is answered in plain, as it would not understand more.
  [[nodiscard]] bool peer_speaks_plain_http(Error error) {
    const bool plain = error.category() == boost::asio::error::get_ssl_category() &&
                       ERR_GET_REASON(static_cast<unsigned long>(error.value())) == SSL_R_HTTP_REQUEST;
    if (plain) secure_.reset();
    return plain;
  }
  template <class Buffer, class Done>
  void read_some(const Buffer& to, Done done) {
    if (secure_)
      secure_->async_read_some(to, std::move(done));
    else
      socket_.async_read_some(to, std::move(done));
  }
  template <class Buffer, class Done>
  void write(const Buffer& from, Done done) {
    if (secure_)
      boost::asio::async_write(*secure_, from, std::move(done));
    else
      boost::asio::async_write(socket_, from, std::move(done));
  }
  /// Tells the peer that nothing more comes. done(Error): what it still sends can be read_raw().
  template <class Done>
  void end(Done done) {
    auto end_socket = [this, done = std::move(done)](Error) mutable {
      Error error;
      socket_.shutdown(Socket::shutdown_send, error);
      done(error);
    };
    if (secure_)
      secure_->async_shutdown(end_socket);  // its own error says that the peer still sends, or is gone
    else
      end_socket(Error());
  }
  /// Whatever is on the socket.
  template <class Buffer, class Done>
  void read_raw(const Buffer& to, Done done) {
    socket_.async_read_some(to, std::move(done));
  }
  void close() {
    Error ignored;
    socket_.close(ignored);
  }

 private:
  Socket socket_;
  std::shared_ptr<const TlsIdentity> tls_;
  std::optional<boost::asio::ssl::stream<Socket&>> secure_;
};

}  // namespace luxrig

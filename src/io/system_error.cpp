#include "rbvi/io/system_error.hpp"

#include <cerrno>
#include <cstring>

namespace rbvi {

std::string system_reason() {
  return errno != 0 ? std::string(": ") + std::strerror(errno) : "";
}

namespace {

bool is_full() {
#ifdef EDQUOT // not on every system
  if (errno == EDQUOT) return true;
#endif
  return errno == ENOSPC || errno == EFBIG;
}

} // namespace

Error cannot_write(const std::string &what) {
  const bool full = is_full();
  return failure("cannot write " + what + system_reason() +
                 (full ? "; make room and start the same command again" : ""));
}

std::string in_plain_words(std::string message) {
  const std::string name = "std::bad_alloc", plain = "out of memory";
  if (const std::size_t at = message.find(name); at != std::string::npos)
    message.replace(at, name.size(), plain);
  if (message.find(plain) != std::string::npos)
    message += "; try a coarser mesh, fewer processes on each node, or a node with more memory";
  return message;
}

} // namespace rbvi

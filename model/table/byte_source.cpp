#include "model/table/byte_source.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

namespace fogbench::model {
namespace {

constexpr std::size_t kArchiveBuffer = std::size_t{1} << 18;
/// Of an archive's history: 128 MiB, what the program zstd takes without being asked.
constexpr int kLargestWindowLog = 27;

Error damaged(std::string message) {
  return {ErrorCode::kBadInput, std::move(message)};
}

class FileBytes final : public ByteSource {
 public:
  explicit FileBytes(int descriptor) : descriptor_(descriptor) {}
  ~FileBytes() override { ::close(descriptor_); }
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  Result<std::size_t> read(std::span<char> into) override {
    ssize_t got = 0;
    do {
      got = ::read(descriptor_, into.data(), into.size());
    } while (got < 0 && errno == EINTR);
    if (got < 0) return damaged(fmt::format("cannot be read: {}", std::strerror(errno)));
    return static_cast<std::size_t>(got);
  }

 private:
  int descriptor_;
};

class PutBack final : public ByteSource {
 public:
  PutBack(std::string taken, std::unique_ptr<ByteSource> rest)
      : taken_(std::move(taken)), rest_(std::move(rest)) {}

  Result<std::size_t> read(std::span<char> into) override {
    if (given_ == taken_.size()) return rest_->read(into);
    const std::size_t some = std::min(into.size(), taken_.size() - given_);
    std::copy_n(taken_.data() + given_, some, into.data());
    given_ += some;
    return some;
  }

 private:
  std::string taken_;
  std::size_t given_ = 0;
  std::unique_ptr<ByteSource> rest_;
};

/// What both archives share: a buffer of packed bytes.
class Unpacked : public ByteSource {
 protected:
  explicit Unpacked(std::unique_ptr<ByteSource> packed)
      : packed_(std::move(packed)), buffer_(kArchiveBuffer) {}

  /// Bytes that were not unpacked yet; none at the end.
  Result<std::span<char>> packed() {
    if (begin_ == end_) {
      const auto got = packed_->read(buffer_);
      if (!got) return got.error();
      begin_ = 0;
      end_ = *got;
    }
    return std::span(buffer_).subspan(begin_, end_ - begin_);
  }
  void taken(std::size_t bytes) { begin_ += bytes; }

 private:
  std::unique_ptr<ByteSource> packed_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;
};

class GzipBytes final : public Unpacked {
 public:
  explicit GzipBytes(std::unique_ptr<ByteSource> packed) : Unpacked(std::move(packed)) {
    constexpr int kGzipWindow = 15 + 16;
    ready_ = inflateInit2(&stream_, kGzipWindow) == Z_OK;
  }
  ~GzipBytes() override { inflateEnd(&stream_); }
  GzipBytes(const GzipBytes&) = delete;
  GzipBytes& operator=(const GzipBytes&) = delete;

  Result<std::size_t> read(std::span<char> into) override {
    if (!ready_) return damaged("cannot be unpacked: zlib has no memory");
    while (true) {
      const auto in = packed();
      if (!in) return in.error();
      if (in->empty()) {
        if (between_members_) return std::size_t{0};
        return damaged("the gzip archive ends too early: it was cut off");
      }
      // A file may be several archives one after the other.
      if (between_members_) inflateReset(&stream_);
      between_members_ = false;
      stream_.next_in = reinterpret_cast<Bytef*>(in->data());
      stream_.avail_in = static_cast<uInt>(in->size());
      stream_.next_out = reinterpret_cast<Bytef*>(into.data());
      stream_.avail_out = static_cast<uInt>(std::min(into.size(), kMostAtOnce));
      const uInt room = stream_.avail_out;
      const int outcome = inflate(&stream_, Z_NO_FLUSH);
      taken(in->size() - stream_.avail_in);
      if (outcome != Z_OK && outcome != Z_STREAM_END && outcome != Z_BUF_ERROR) {
        return damaged(fmt::format("the gzip archive is damaged: {}",
                                   stream_.msg != nullptr ? stream_.msg : "wrong data"));
      }
      between_members_ = outcome == Z_STREAM_END;
      if (stream_.avail_out < room) return std::size_t{room - stream_.avail_out};
    }
  }

 private:
  static constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;

  z_stream stream_{};
  bool ready_ = false, between_members_ = false;
};

class ZstdBytes final : public Unpacked {
 public:
  explicit ZstdBytes(std::unique_ptr<ByteSource> packed)
      : Unpacked(std::move(packed)), context_(ZSTD_createDCtx()) {
    if (context_ != nullptr) {
      ZSTD_DCtx_setParameter(context_, ZSTD_d_windowLogMax, kLargestWindowLog);
    }
  }
  ~ZstdBytes() override { ZSTD_freeDCtx(context_); }
  ZstdBytes(const ZstdBytes&) = delete;
  ZstdBytes& operator=(const ZstdBytes&) = delete;

  Result<std::size_t> read(std::span<char> into) override {
    if (context_ == nullptr) return damaged("cannot be unpacked: zstd has no memory");
    while (true) {
      const auto in = packed();
      if (!in) return in.error();
      if (in->empty() && wanted_ == 0) return std::size_t{0};
      ZSTD_inBuffer from{in->data(), in->size(), 0};
      ZSTD_outBuffer to{into.data(), into.size(), 0};
      wanted_ = ZSTD_decompressStream(context_, &to, &from);
      taken(from.pos);
      if (ZSTD_isError(wanted_) != 0) {
        return damaged(fmt::format("the zstd archive is damaged: {}", ZSTD_getErrorName(wanted_)));
      }
      if (to.pos > 0) return to.pos;
      if (in->empty()) return damaged("the zstd archive ends too early: it was cut off");
    }
  }

 private:
  ZSTD_DCtx* context_;
  std::size_t wanted_ = 1;  ///< 0: between archives
};

}  // namespace

Result<std::string> first_bytes(ByteSource& source, std::size_t most) {
  std::string bytes(most, '\0');
  std::size_t filled = 0;
  while (filled < most) {
    const auto got = source.read(std::span(bytes).subspan(filled));
    if (!got) return got.error();
    if (*got == 0) break;
    filled += *got;
  }
  bytes.resize(filled);
  return bytes;
}

std::unique_ptr<ByteSource> put_back(std::string taken, std::unique_ptr<ByteSource> rest) {
  return std::make_unique<PutBack>(std::move(taken), std::move(rest));
}

Result<OpenedBytes> open_bytes(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (descriptor < 0 || ::fstat(descriptor, &status) != 0) {
    const int reason = errno;
    if (descriptor >= 0) ::close(descriptor);
    return damaged(fmt::format("{}: cannot be opened: {}", file.string(), std::strerror(reason)));
  }
  OpenedBytes opened{std::make_unique<FileBytes>(descriptor), {}, 0};
  if (S_ISDIR(status.st_mode)) {
    return damaged(fmt::format("{}: found a directory, expected a table", file.string()));
  }
  opened.file_bytes = static_cast<std::size_t>(std::max<off_t>(status.st_size, 0));
  constexpr std::size_t kMagic = 4;
  auto magic = first_bytes(*opened.bytes, kMagic);
  if (!magic) {
    return damaged(fmt::format("{}: {}", file.string(), magic.error().message));
  }
  const bool gzip = magic->starts_with("\x1f\x8b"), zstd = *magic == "\x28\xb5\x2f\xfd";
  opened.bytes = put_back(std::move(*magic), std::move(opened.bytes));
  if (gzip) {
    opened.archive = "gzip";
    opened.bytes = std::make_unique<GzipBytes>(std::move(opened.bytes));
  } else if (zstd) {
    opened.archive = "zstd";
    opened.bytes = std::make_unique<ZstdBytes>(std::move(opened.bytes));
  }
  return opened;
}

}  // namespace fogbench::model

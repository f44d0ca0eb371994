#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

/// Reads a program stream pack by pack and plays the system target decoder on it. [H222, 2.5.2 and 2.5.3]
namespace render2mpeg::test {

struct Pack {
    double scr = 0;                  ///< seconds: when its first byte arrives
    double rate = 0;                 ///< bytes per second
    std::size_t bytes = 0;           ///< of the whole pack
    std::size_t payload = 0;         ///< of video in it
    std::optional<double> pts, dts;  ///< seconds, of the first picture that begins in it
};

struct ProgramStream {
    std::vector<Pack> packs;
    std::size_t buffer_bytes = 0;  ///< P-STD_buffer_size of the video stream
    bool has_system_header = false;
    bool has_end_code = false;
};

class ProgramStreamReader {
  public:
    explicit ProgramStreamReader(const std::vector<std::uint8_t>& bytes) : b_(bytes) {}

    ProgramStream read() {
        while (at_ + 4 <= b_.size()) {
            if (b_[at_] != 0 || b_[at_ + 1] != 0 || b_[at_ + 2] != 1)
                throw std::runtime_error("no start code where one belongs");
            const std::uint8_t code = b_[at_ + 3];
            const std::size_t begin = at_;
            if (code == 0xba) {
                read_pack_header();
            } else if (code == 0xb9) {
                stream_.has_end_code = true;
                at_ += 4;
            } else {
                const std::size_t length = word(4);
                if (code == 0xbb) stream_.has_system_header = true;
                if (code == 0xe0) read_video(begin, 6 + length);
                at_ += 6 + length;
            }
            if (!stream_.packs.empty() && code != 0xb9) stream_.packs.back().bytes += at_ - begin;
        }
        return stream_;
    }

  private:
    std::uint64_t byte(std::size_t offset) const { return b_.at(at_ + offset); }
    std::size_t word(std::size_t offset) const {
        return static_cast<std::size_t>(byte(offset) << 8 | byte(offset + 1));
    }

    void read_pack_header() {
        if ((byte(4) & 0xc4) != 0x44) throw std::runtime_error("not an MPEG-2 pack header");
        const std::uint64_t base = (byte(4) >> 3 & 7) << 30 | (byte(4) & 3) << 28 | byte(5) << 20 |
                                   (byte(6) >> 3) << 15 | (byte(6) & 3) << 13 | byte(7) << 5 | byte(8) >> 3;
        const std::uint64_t extension = (byte(8) & 3) << 7 | byte(9) >> 1;
        Pack pack;
        pack.scr = static_cast<double>(base * 300 + extension) / 27e6;
        pack.rate = 50.0 * static_cast<double>(byte(10) << 14 | byte(11) << 6 | byte(12) >> 2);
        stream_.packs.push_back(pack);
        at_ += 14 + (byte(13) & 7);
    }

    double timestamp(std::size_t offset) const {
        const std::uint64_t t = (byte(offset) >> 1 & 7) << 30 | byte(offset + 1) << 22 | (byte(offset + 2) >> 1) << 15 |
                                byte(offset + 3) << 7 | byte(offset + 4) >> 1;
        return static_cast<double>(t) / 90000;
    }

    void read_video(std::size_t, std::size_t length) {
        Pack& pack = stream_.packs.at(stream_.packs.size() - 1);
        const std::uint64_t flags = byte(7), header = byte(8);
        std::size_t at = 9;
        if (flags & 0x80) {
            pack.pts = pack.dts = timestamp(at);
            at += 5;
        }
        if (flags & 0x40) {
            pack.dts = timestamp(at);
            at += 5;
        }
        if (flags & 0x01 && byte(at) & 0x10) {
            const std::size_t size = word(at + 1);
            stream_.buffer_bytes = (size & 0x1fff) * (size & 0x2000 ? 1024 : 128);
        }
        pack.payload += length - 9 - header;
    }

    const std::vector<std::uint8_t>& b_;
    std::size_t at_ = 0;
    ProgramStream stream_;
};

}  // namespace render2mpeg::test

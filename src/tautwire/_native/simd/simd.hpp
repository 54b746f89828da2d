// SIMD lanes of fixed width, one width per instruction set.
//
// TAUTWIRE_LANES doubles fill one register: 2 on SSE and NEON, 4 on AVX2, 8 on AVX-512. `Floats`
// has the same size and therefore twice as many lanes.
//
// This header and all that include it are compiled once per instruction set. Everything lives in a
// namespace named after the instruction set, and no standard container is used, because the linker
// keeps only one copy of a template function: it could be the one that old processors cannot run.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <new>
#include <type_traits>
#include <utility>

#ifndef TAUTWIRE_LANES
#error "define TAUTWIRE_LANES (doubles per register) and TAUTWIRE_ISA (name of the instruction set)"
#endif

// Whether the compiler has vector types. clang has them whichever compiler it stands in for, with
// cl's command line too, where __GNUC__ is not defined. The build sets 0 for the plain kernels.
#ifndef TAUTWIRE_VECTORS
#if defined(__clang__) || defined(__GNUC__)
#define TAUTWIRE_VECTORS 1
#else
#define TAUTWIRE_VECTORS 0
#endif
#endif

// The instructions of x86-64 that fit the lanes.
#if TAUTWIRE_VECTORS && defined(__AVX512DQ__) && TAUTWIRE_LANES == 8
#define TAUTWIRE_AVX512
#elif TAUTWIRE_VECTORS && defined(__AVX__) && TAUTWIRE_LANES == 4
#define TAUTWIRE_AVX
#elif TAUTWIRE_VECTORS && defined(__SSE2__) && TAUTWIRE_LANES == 2
#define TAUTWIRE_SSE
#endif
#if defined(TAUTWIRE_AVX512) || defined(TAUTWIRE_AVX) || defined(TAUTWIRE_SSE)
#include <immintrin.h>
#endif

#if defined(__clang__)
#define TAUTWIRE_INLINE [[gnu::always_inline]] inline
#define TAUTWIRE_UNROLL _Pragma("unroll")
#elif defined(__GNUC__)
#define TAUTWIRE_INLINE [[gnu::always_inline]] inline
#define TAUTWIRE_UNROLL _Pragma("GCC unroll 16")
#else
#define TAUTWIRE_INLINE __forceinline
#define TAUTWIRE_UNROLL
#endif

namespace tautwire::TAUTWIRE_ISA {

inline constexpr int kLanes = TAUTWIRE_LANES;

#if TAUTWIRE_VECTORS

template <class T, int N>
struct PackOf {
    typedef T type __attribute__((vector_size(N * sizeof(T))));
};
template <class T, int N>
using Pack = typename PackOf<T, N>::type;

#else  // compilers without vector extensions: a plain array that the optimiser may vectorise

template <class T, int N>
struct alignas(N * sizeof(T)) Pack {
    T lane[N];
    T& operator[](int i) { return lane[i]; }
    T operator[](int i) const { return lane[i]; }
};

#define TAUTWIRE_OPERATOR(op)                                                                    \
    template <class T, int N>                                                                    \
    TAUTWIRE_INLINE Pack<T, N> operator op(const Pack<T, N>& a, const Pack<T, N>& b) {           \
        Pack<T, N> c;                                                                            \
        for (int i = 0; i < N; ++i) c.lane[i] = a.lane[i] op b.lane[i];                          \
        return c;                                                                                \
    }                                                                                            \
    template <class T, int N>                                                                    \
    TAUTWIRE_INLINE Pack<T, N> operator op(T a, const Pack<T, N>& b) {                           \
        Pack<T, N> c;                                                                            \
        for (int i = 0; i < N; ++i) c.lane[i] = a op b.lane[i];                                  \
        return c;                                                                                \
    }                                                                                            \
    template <class T, int N>                                                                    \
    TAUTWIRE_INLINE Pack<T, N> operator op(const Pack<T, N>& a, T b) {                           \
        Pack<T, N> c;                                                                            \
        for (int i = 0; i < N; ++i) c.lane[i] = a.lane[i] op b;                                  \
        return c;                                                                                \
    }                                                                                            \
    template <class T, int N>                                                                    \
    TAUTWIRE_INLINE Pack<T, N>& operator op##=(Pack<T, N>& a, const Pack<T, N>& b) {             \
        return a = a op b;                                                                       \
    }
TAUTWIRE_OPERATOR(+)
TAUTWIRE_OPERATOR(-)
TAUTWIRE_OPERATOR(*)
TAUTWIRE_OPERATOR(/)
#undef TAUTWIRE_OPERATOR

template <class T, int N>
TAUTWIRE_INLINE Pack<T, N> operator-(const Pack<T, N>& a) {
    return T(0) - a;
}

#endif

using Doubles = Pack<double, kLanes>;
using Floats = Pack<float, 2 * kLanes>;

template <class V>
inline constexpr int kLanesOf = static_cast<int>(sizeof(V) / sizeof(std::declval<V&>()[0]));

// Loops over lanes; compilers turn them into single instructions.

template <class V>
TAUTWIRE_INLINE V broadcast(double value) {
    V out = {};
    for (int i = 0; i < kLanesOf<V>; ++i) out[i] = static_cast<std::decay_t<decltype(out[0])>>(value);
    return out;
}

template <class V>
TAUTWIRE_INLINE V square_root(V x) {
    for (int i = 0; i < kLanesOf<V>; ++i) x[i] = std::sqrt(x[i]);
    return x;
}

template <class V>
TAUTWIRE_INLINE V absolute(V x) {
    for (int i = 0; i < kLanesOf<V>; ++i) x[i] = std::fabs(x[i]);
    return x;
}

// Lane by lane: x where a > b, else y.
template <class V>
TAUTWIRE_INLINE V where_greater(V a, V b, V x, V y) {
#if TAUTWIRE_VECTORS
    return a > b ? x : y;
#else
    for (int i = 0; i < kLanesOf<V>; ++i) y[i] = a[i] > b[i] ? x[i] : y[i];
    return y;
#endif
}

// Lane-wise maximum and minimum; of a pair with a NaN, b.
template <class V>
TAUTWIRE_INLINE V maximum(V a, V b) {
    return where_greater(a, b, a, b);
}
template <class V>
TAUTWIRE_INLINE V minimum(V a, V b) {
    return where_greater(b, a, a, b);
}

// Lane i of the result is lane index(i) of a and b, which follow each other.
#if TAUTWIRE_VECTORS && defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define TAUTWIRE_SHUFFLES
#endif
#endif

#ifdef TAUTWIRE_SHUFFLES
template <class V, class Index, std::size_t... I>
TAUTWIRE_INLINE auto shuffle(V a, V b, Index, std::index_sequence<I...>) {
    return __builtin_shufflevector(a, b, Index{}(static_cast<int>(I))...);
}
template <int N, class V, class Index>
TAUTWIRE_INLINE auto shuffle(V a, V b, Index index) {
    return shuffle(a, b, index, std::make_index_sequence<N>());
}
#else
template <int N, class V, class Index>
TAUTWIRE_INLINE auto shuffle(V a, V b, Index index) {
    constexpr int n = kLanesOf<V>;
    Pack<std::decay_t<decltype(a[0])>, N> out = {};
    for (int i = 0; i < N; ++i) out[i] = index(i) < n ? a[index(i)] : b[index(i) - n];
    return out;
}
#endif

// The largest lane; halves are compared, so that few comparisons wait for each other.
template <class V>
TAUTWIRE_INLINE double largest_lane(V x) {
    constexpr int half = kLanesOf<V> / 2;
    if constexpr (half == 1) {
        return x[0] > x[1] ? x[0] : x[1];
    } else {
        return largest_lane(maximum(shuffle<half>(x, x, [](int i) constexpr { return i; }),
                                    shuffle<half>(x, x, [](int i) constexpr { return half + i; })));
    }
}

#if TAUTWIRE_VECTORS
template <class To, class V>
TAUTWIRE_INLINE To convert(V x) {
    return __builtin_convertvector(x, To);
}
#else
template <class To, class V>
TAUTWIRE_INLINE To convert(V x) {
    To out = {};
    for (int i = 0; i < kLanesOf<V>; ++i) out[i] = static_cast<std::decay_t<decltype(out[0])>>(x[i]);
    return out;
}
#endif

// Whether a > b in any lane.
template <class V>
TAUTWIRE_INLINE bool any_greater(V a, V b) {
#if TAUTWIRE_VECTORS
    const auto narrow = convert<Pack<signed char, kLanesOf<V>>>(a > b);
    std::uint64_t words[(sizeof(narrow) + 7) / 8] = {}, any = 0;
    std::memcpy(words, &narrow, sizeof(narrow));
    for (const std::uint64_t word : words) any |= word;
    return any != 0;
#else
    return largest_lane(a - b) > 0;
#endif
}

// The lanes of the first half, then those of the second, rounded to single precision.
TAUTWIRE_INLINE Floats join(Doubles first, Doubles second) {
#if defined(TAUTWIRE_SSE)
    return _mm_movelh_ps(_mm_cvtpd_ps(first), _mm_cvtpd_ps(second));
#else
    using Half = Pack<float, kLanes>;
    return shuffle<2 * kLanes>(
        convert<Half>(first), convert<Half>(second), [](int i) constexpr { return i; });
#endif
}

// The lanes of one half. GCC 12 makes up to seven instructions of this conversion, which is one, so it is
// asked for by name.
TAUTWIRE_INLINE Doubles widen(Floats x, int half) {
#if defined(TAUTWIRE_SSE)
    return _mm_cvtps_pd(half ? _mm_movehl_ps(x, x) : x);
#else
    const auto lanes = half ? shuffle<kLanes>(x, x, [](int i) constexpr { return kLanes + i; })
                            : shuffle<kLanes>(x, x, [](int i) constexpr { return i; });
#if defined(TAUTWIRE_AVX512)
    return _mm512_maskz_cvtps_pd(0xff, lanes);  // the plain form warns in GCC's header
#elif defined(TAUTWIRE_AVX)
    return _mm256_cvtps_pd(lanes);
#else
    return convert<Doubles>(lanes);
#endif
#endif
}

// Values at places in an array, one for each lane.
TAUTWIRE_INLINE Doubles gather(const double* from, const int* at) {
    Doubles out = {};
    for (int lane = 0; lane < kLanes; ++lane) out[lane] = from[at[lane]];
    return out;
}

// Move every value to the next (previous) piece; zero enters at the end. A vector of floats holds
// all pieces, a pair of vectors of doubles their halves.
TAUTWIRE_INLINE Floats to_next_piece(Floats x) {
    return shuffle<2 * kLanes>(x, broadcast<Floats>(0.0), [](int i) constexpr {
        return i == 0 ? 2 * kLanes : i - 1;
    });
}
TAUTWIRE_INLINE Floats to_previous_piece(Floats x) {
    return shuffle<2 * kLanes>(
        x, broadcast<Floats>(0.0), [](int i) constexpr { return i + 1; });
}
TAUTWIRE_INLINE void to_next_piece(Doubles (&x)[2]) {
    const auto from_before = [](int i) constexpr { return i == 0 ? 2 * kLanes - 1 : i - 1; };
    x[1] = shuffle<kLanes>(x[1], x[0], from_before);
    x[0] = shuffle<kLanes>(x[0], broadcast<Doubles>(0.0), from_before);
}
TAUTWIRE_INLINE void to_previous_piece(Doubles (&x)[2]) {
    const auto from_behind = [](int i) constexpr { return i + 1; };
    x[0] = shuffle<kLanes>(x[0], x[1], from_behind);
    x[1] = shuffle<kLanes>(x[1], broadcast<Doubles>(0.0), from_behind);
}

// A block of memory aligned for vectors, zero at the start, for values that may be copied bytewise.
template <class T>
class Buffer {
public:
    Buffer() = default;
    explicit Buffer(std::size_t size)
        : data_(static_cast<T*>(::operator new(size * sizeof(T), std::align_val_t(kAlignment)))),
          size_(size) {
        std::memset(static_cast<void*>(data_), 0, size * sizeof(T));
    }
    Buffer(Buffer&& other) noexcept : data_(other.data_), size_(other.size_) {
        other.data_ = nullptr;
        other.size_ = 0;
    }
    Buffer& operator=(Buffer&& other) noexcept {
        T* data = data_;
        std::size_t size = size_;
        data_ = other.data_;
        size_ = other.size_;
        other.data_ = data;
        other.size_ = size;
        return *this;
    }
    Buffer(const Buffer&) = delete;
    Buffer& operator=(const Buffer&) = delete;
    ~Buffer() {
        if (data_) ::operator delete(data_, std::align_val_t(kAlignment));
    }

    T& operator[](std::size_t i) { return data_[i]; }
    const T& operator[](std::size_t i) const { return data_[i]; }
    T* data() { return data_; }
    const T* data() const { return data_; }
    std::size_t size() const { return size_; }
    T* begin() { return data_; }
    T* end() { return data_ + size_; }
    const T* begin() const { return data_; }
    const T* end() const { return data_ + size_; }
    // Make room for more; what is there stays, the rest is zero.
    void grow(std::size_t size) {
        if (size <= size_) return;
        Buffer larger(size);
        if (size_ > 0) std::memcpy(static_cast<void*>(larger.data_), data_, size_ * sizeof(T));
        *this = std::move(larger);
    }
    void copy_from(const Buffer& other) { std::memcpy(static_cast<void*>(data_), other.data_, size_ * sizeof(T)); }

private:
    static constexpr std::size_t kAlignment = 64;  // a cache line, and the widest vector
    T* data_ = nullptr;
    std::size_t size_ = 0;
};

// A list that grows; for types that can be copied byte by byte.
template <class T>
class List {
public:
    void push(const T& entry) {
        if (size_ == data_.size()) data_.grow(2 * size_ + 16);
        data_[size_++] = entry;
    }
    void shorten(std::size_t size) { size_ = size; }
    void reserve(std::size_t size) { data_.grow(size); }
    std::size_t size() const { return size_; }
    T& operator[](std::size_t i) { return data_[i]; }
    const T& operator[](std::size_t i) const { return data_[i]; }
    T* begin() { return data_.data(); }
    T* end() { return data_.data() + size_; }
    const T* begin() const { return data_.data(); }
    const T* end() const { return data_.data() + size_; }

private:
    Buffer<T> data_;
    std::size_t size_ = 0;
};

}  // namespace tautwire::TAUTWIRE_ISA

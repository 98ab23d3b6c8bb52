// Functions for vector instructions.
#pragma once

/// Before a function: one version of it for each kind of vector instructions; the loader takes the best that the
/// processor has. All give the same bits, as long as the function adds up in an order of its own.
#if defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define ANATOMESH_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define ANATOMESH_VECTOR_CLONES
#endif

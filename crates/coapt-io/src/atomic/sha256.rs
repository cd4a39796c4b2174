//! Checksums that the tools of every system know: SHA-256 (FIPS 180-4).

/// Bytes of a block.
const BLOCK: usize = 64;

/// The checksum of some bytes, as 64 hexadecimal digits.
pub(super) fn hexadecimal(bytes: &[u8]) -> String {
    let keys: [u32; 64] = fractions(3);
    let mut state: [u32; 8] = fractions(2);
    let blocks = bytes.chunks_exact(BLOCK);
    let mut end = blocks.remainder().to_vec();
    blocks.for_each(|block| compress(&mut state, block, &keys));
    // A one, zeros, and the number of bits at the end of a block.
    end.push(0x80);
    end.resize((end.len() + 8).next_multiple_of(BLOCK) - 8, 0);
    end.extend((8 * bytes.len() as u64).to_be_bytes());
    end.chunks_exact(BLOCK)
        .for_each(|block| compress(&mut state, block, &keys));
    state.iter().map(|word| format!("{word:08x}")).collect()
}

/// The first 32 bits behind the point of square or cube roots of the first primes (sections 4.2.2 and 5.3.3).
fn fractions<const COUNT: usize>(degree: u32) -> [u32; COUNT] {
    let is_prime = |number: &u128| (2..*number).all(|divisor| !number.is_multiple_of(divisor));
    let mut primes = (2..).filter(is_prime);
    std::array::from_fn(|_| {
        let shifted = primes.next().unwrap_or_default() << (32 * degree);
        // The largest number whose power is not more, bit by bit; roots of numbers up to 311 have 37 bits at most.
        let mut root = 0_u128;
        for bit in (0..37).rev() {
            let larger = root | 1 << bit;
            if larger.pow(degree) <= shifted {
                root = larger;
            }
        }
        root as u32
    })
}

/// Takes a block into the state (section 6.2.2, whose letters these are).
fn compress(state: &mut [u32; 8], block: &[u8], keys: &[u32; 64]) {
    let mut w = [0_u32; 64];
    for (word, bytes) in w.iter_mut().zip(block.chunks_exact(4)) {
        *word = bytes
            .iter()
            .fold(0, |number, &byte| number << 8 | u32::from(byte));
    }
    for t in 16..64 {
        let s0 = w[t - 15].rotate_right(7) ^ w[t - 15].rotate_right(18) ^ w[t - 15] >> 3;
        let s1 = w[t - 2].rotate_right(17) ^ w[t - 2].rotate_right(19) ^ w[t - 2] >> 10;
        w[t] = w[t - 16].wrapping_add(s0).wrapping_add(w[t - 7]).wrapping_add(s1);
    }
    let [mut a, mut b, mut c, mut d, mut e, mut f, mut g, mut h] = *state;
    for (key, word) in keys.iter().zip(w) {
        let s1 = e.rotate_right(6) ^ e.rotate_right(11) ^ e.rotate_right(25);
        let choice = (e & f) ^ (!e & g);
        let t1 = h
            .wrapping_add(s1)
            .wrapping_add(choice)
            .wrapping_add(*key)
            .wrapping_add(word);
        let s0 = a.rotate_right(2) ^ a.rotate_right(13) ^ a.rotate_right(22);
        let majority = (a & b) ^ (a & c) ^ (b & c);
        (h, g, f, e) = (g, f, e, d.wrapping_add(t1));
        (d, c, b, a) = (c, b, a, t1.wrapping_add(s0.wrapping_add(majority)));
    }
    for (word, more) in state.iter_mut().zip([a, b, c, d, e, f, g, h]) {
        *word = word.wrapping_add(more);
    }
}

/// Of the standard's examples and of lengths around a block's, as `sha256sum` (GNU coreutils) gives them.
#[test]
fn checksums_are_those_of_the_standard() {
    let of = |text: &str| hexadecimal(text.as_bytes());
    assert_eq!(
        of("abc"),
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    );
    assert_eq!(
        of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"
    );
    assert_eq!(
        of(&"a".repeat(0)),
        "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"
    );
    assert_eq!(
        of(&"a".repeat(55)),
        "9f4390f8d30c2dd92ec9f095b65e2b9ae9b0a925a5258e241c9f1e910f734318"
    );
    assert_eq!(
        of(&"a".repeat(56)),
        "b35439a4ac6f0948b6d6f9e3c6af0f5f590ce20f1bde7090ef7970686ec6738a"
    );
    assert_eq!(
        of(&"a".repeat(63)),
        "7d3e74a05d7db15bce4ad9ec0658ea98e3f06eeecf16b4c6fff2da457ddc2f34"
    );
    assert_eq!(
        of(&"a".repeat(64)),
        "ffe054fe7ae0cb6dc65c3af9b61d5209f439851db43d0ba5997337df154668eb"
    );
    assert_eq!(
        of(&"a".repeat(65)),
        "635361c48bb9eab14198e76ea8ab7f1a41685d6ad62aa9146d301d4f17eb0ae0"
    );
    assert_eq!(
        of(&"a".repeat(1000)),
        "41edece42d63e8d9bf515a9ba6932e1c20cbc9f5a5d134645adb5db1b9737ea3"
    );
}

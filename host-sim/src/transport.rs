//! The wire to a controller: a serial port, a file such as a pseudo-terminal, or TCP.

use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use crate::input::InputError;

/// How long a connection may take.
const PATIENCE: Duration = Duration::from_secs(3);

/// How long a read waits for bytes.
const SLICE: Duration = Duration::from_millis(2);

/// Bytes to and from a controller.
pub trait Transport {
    /// Bytes that have come, after a wait of some milliseconds at most; none where none came. Errors: the line is gone.
    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize>;
    /// Sends all of these.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// Its bits a second, where it is as slow as that; none where nothing is known.
    fn baud(&self) -> Option<u32> {
        None
    }
}

/// Opens `port`: `tcp:HOST:PORT`, a serial port, or a file that is a line. `baud` is for a serial port alone.
pub fn open(port: &str, baud: u32) -> Result<Box<dyn Transport>, InputError> {
    let refused = |error: &dyn std::fmt::Display| InputError::new(port, format_args!("cannot be opened: {error}"));
    if let Some(address) = port.strip_prefix("tcp:") {
        return match connect(address) {
            Ok(stream) => Ok(Box::new(stream)),
            Err(error) => Err(refused(&error)),
        };
    }
    match serialport::new(port, baud).timeout(SLICE).open() {
        Ok(serial) => Ok(Box::new(Serial(serial))),
        Err(_) if !std::path::Path::new(port).exists() => {
            Err(refused(&"there is no such port; name a serial port or tcp:HOST:PORT"))
        }
        // A pseudo-terminal does not know every setting of a serial port.
        Err(error) => match Threaded::open(port) {
            Ok(Some(line)) => Ok(Box::new(line)),
            Ok(None) => Err(refused(&"it is no line; name a serial port or tcp:HOST:PORT")),
            Err(_) => Err(refused(&error)),
        },
    }
}

fn connect(address: &str) -> io::Result<TcpStream> {
    let mut last = io::Error::new(ErrorKind::InvalidInput, "the address has to be HOST:PORT");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, PATIENCE) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(SLICE))?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// Nothing yet is no error.
fn some_or_none(result: io::Result<usize>) -> io::Result<usize> {
    match result {
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted) => {
            Ok(0)
        }
        other => other,
    }
}

fn closed() -> io::Error {
    io::Error::new(ErrorKind::UnexpectedEof, "the other end has closed the line")
}

impl Transport for TcpStream {
    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.read(buffer) {
            Ok(0) => Err(closed()),
            other => some_or_none(other),
        }
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.write_all(bytes)
    }
}

struct Serial(Box<dyn serialport::SerialPort>);

impl Transport for Serial {
    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        some_or_none(self.0.read(buffer))
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.0.write_all(bytes)
    }

    fn baud(&self) -> Option<u32> {
        self.0.baud_rate().ok()
    }
}

/// A file knows no timeout: a thread waits for its bytes.
struct Threaded {
    file: File,
    received: Receiver<io::Result<Vec<u8>>>,
    rest: Vec<u8>,
}

impl Threaded {
    /// None where the path is an ordinary file or a directory.
    fn open(path: &str) -> io::Result<Option<Self>> {
        let kind = std::fs::metadata(path)?;
        if kind.is_file() || kind.is_dir() {
            return Ok(None);
        }
        let file = OpenOptions::new().read(true).write(true).open(path)?;
        let (sender, received) = channel();
        let reader = file.try_clone()?;
        std::thread::spawn(move || pump(reader, &sender));
        Ok(Some(Self { file, received, rest: Vec::new() }))
    }
}

fn pump(mut file: File, to: &Sender<io::Result<Vec<u8>>>) {
    let mut buffer = [0; 1024];
    loop {
        let message = match file.read(&mut buffer) {
            Ok(0) => Err(closed()),
            Ok(count) => Ok(buffer.iter().copied().take(count).collect()),
            Err(error) => Err(error),
        };
        let ends = message.is_err();
        if to.send(message).is_err() || ends {
            return;
        }
    }
}

impl Transport for Threaded {
    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.rest.is_empty() {
            match self.received.recv_timeout(SLICE) {
                Ok(bytes) => self.rest = bytes?,
                Err(RecvTimeoutError::Timeout) => return Ok(0),
                Err(RecvTimeoutError::Disconnected) => return Err(closed()),
            }
        }
        let count = self.rest.len().min(buffer.len());
        for (place, byte) in buffer.iter_mut().zip(self.rest.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)
    }
}

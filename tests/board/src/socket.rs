//! A TCP listener as the far end of the serial line: byte for byte, one host at a time.
//!
//! A line of three wires has one far end. A host that connects while another is there waits in the listener's queue until that one has
//! left. What a host does not read is lost once 4 kB wait for it, as on a serial port.
//!
//! The socket is looked at when the driver of the run says so, never by the board: in between, what has come and what is to go waits
//! in two queues, and the port takes it at its own baud rate.

use std::collections::VecDeque;
use std::fmt;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};

use rigless::chip::Timeline;
use rigless::chip::uart::Peer;
use rigless::snapshot::Store;
use rigless::time::VirtualNanos;

use crate::line::{Shared, lock};

/// Bytes that may wait in either direction.
const KEPT: usize = 4_096;

/// What has passed since the listener was opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Hosts that connected.
    pub hosts: u32,
    /// Bytes from hosts.
    pub from_hosts: u64,
    /// Bytes to hosts.
    pub to_hosts: u64,
}

/// See the module.
#[derive(Debug)]
pub struct Socket {
    listener: TcpListener,
    host: Option<TcpStream>,
    incoming: VecDeque<u8>,
    outgoing: VecDeque<u8>,
    traffic: Traffic,
}

/// What a look at the socket found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// Whether a host is there.
    pub connected: bool,
    /// Whether it said something since the last look.
    pub heard: bool,
}

impl Socket {
    /// Waits for hosts at `listener`.
    pub fn new(listener: TcpListener) -> std::io::Result<Self> {
        listener.set_nonblocking(true)?;
        Ok(Self {
            listener,
            host: None,
            incoming: VecDeque::new(),
            outgoing: VecDeque::new(),
            traffic: Traffic::default(),
        })
    }

    /// What has passed.
    pub fn traffic(&self) -> Traffic {
        self.traffic
    }

    /// Looks for a host, takes what it says and hands over what is there for it.
    pub fn look(&mut self) -> Look {
        if self.host.is_none() {
            self.accept();
        }
        let before = self.traffic.from_hosts;
        if !(self.read() && self.write()) {
            self.host = None;
        }
        Look { connected: self.host.is_some(), heard: self.traffic.from_hosts != before }
    }

    fn accept(&mut self) {
        // What was said while nobody was there is not for the one who comes.
        self.outgoing.clear();
        let Ok((stream, _)) = self.listener.accept() else { return };
        // A host whose socket cannot be set up is one that has left already.
        if stream.set_nonblocking(true).and_then(|()| stream.set_nodelay(true)).is_ok() {
            self.traffic.hosts += 1;
            self.host = Some(stream);
        }
    }

    /// Takes what has come, as far as there is room: the rest stays in the socket, and its sender waits. False where the host is gone.
    fn read(&mut self) -> bool {
        let Some(host) = &mut self.host else { return true };
        let mut buffer = [0; KEPT];
        loop {
            let room = KEPT.saturating_sub(self.incoming.len());
            if room == 0 {
                return true;
            }
            match host.read(&mut buffer[..room]) {
                Ok(0) => return false,
                Ok(count) => {
                    self.incoming.extend(&buffer[..count]);
                    self.traffic.from_hosts += count as u64;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return error.kind() == ErrorKind::WouldBlock,
            }
        }
    }

    /// Hands over what waits. False where the host is gone.
    fn write(&mut self) -> bool {
        let Some(host) = &mut self.host else { return true };
        while !self.outgoing.is_empty() {
            match host.write(self.outgoing.make_contiguous()) {
                Ok(count) => {
                    self.outgoing.drain(..count);
                    self.traffic.to_hosts += count as u64;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return error.kind() == ErrorKind::WouldBlock,
            }
        }
        true
    }
}

/// The peer at the port's pins.
pub(crate) struct Wire(pub(crate) Shared<Socket>);

impl fmt::Debug for Wire {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Wire").finish_non_exhaustive()
    }
}

impl Store for Wire {}

impl Peer for Wire {
    fn receive(&mut self, word: u16, _: &mut Timeline<'_, '_>) {
        let mut socket = lock(&self.0);
        if socket.outgoing.len() < KEPT {
            socket.outgoing.push_back(word as u8);
        }
    }

    fn transmit(&mut self, _: VirtualNanos) -> Option<u16> {
        lock(&self.0).incoming.pop_front().map(u16::from)
    }
}

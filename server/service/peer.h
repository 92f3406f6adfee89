/* Who is at the other end of a socket, as far as the system knows. Any thread. */
#ifndef SHEEN_SERVICE_PEER_H
#define SHEEN_SERVICE_PEER_H

#define PEER_TEXT_BYTES 80

/* "unix uid=1000 gid=1000 pid=42", or "192.0.2.1:4711"; "unknown" when the peer has gone. */
void peer_describe(int fd, char text[static PEER_TEXT_BYTES]);

#endif

